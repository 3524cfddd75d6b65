// Tools for pictures: painting shapes, laying layers over one another, rows of PNG and frames of GIF.
#include "bindings/bound_state.hpp"
#include "bindings/helpers.hpp"
#include "pictures/gif.hpp"
#include "pictures/names.hpp"
#include "pictures/painter.hpp"
#include "pictures/trails.hpp"

namespace irsim {
namespace {

using PixelArray = nb::ndarray<std::uint8_t, nb::shape<-1, -1, 4>, nb::device::cpu>;
using ReadPixelArray = nb::ndarray<const std::uint8_t, nb::shape<-1, -1, 4>, nb::device::cpu>;
using MaskArray = nb::ndarray<std::uint8_t, nb::shape<-1, -1>, nb::device::cpu>;
using PointArray = nb::ndarray<const double, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using InkArray = nb::ndarray<const std::uint8_t, nb::shape<-1, 4>, nb::c_contig, nb::device::cpu>;
using WidthArray = nb::ndarray<const double, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using RangeArray = nb::ndarray<const std::int64_t, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using BothInksArray = nb::ndarray<const std::uint8_t, nb::shape<-1, 2, 4>, nb::c_contig, nb::device::cpu>;
using BoxArray = nb::ndarray<const double, nb::shape<-1, 4>, nb::c_contig, nb::device::cpu>;
using InkTuple = std::array<double, 4>;

/// Pixels that lie side by side in each row.
template <class Array>
Pixels pixels_of(const Array& array) {
  if (array.stride(2) != 1 || (array.shape(1) > 1 && array.stride(1) != 4))
    throw nb::value_error("the pixels of a row must lie side by side");
  return {const_cast<std::uint8_t*>(array.data()), static_cast<std::ptrdiff_t>(array.stride(0)),
          static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0))};
}

void check_same_size(const Pixels& one, const Pixels& other) {
  if (one.width != other.width || one.height != other.height) throw nb::value_error("the pictures differ in size");
}

using BoxTuple = std::tuple<int, int, int, int>;
using BoxList = std::vector<BoxTuple>;

/// Boxes, which must lie within a picture.
std::vector<PixelBox> boxes_of(const BoxList& list, const Pixels& pixels) {
  std::vector<PixelBox> boxes;
  for (const auto& [left, top, right, bottom] : list) {
    boxes.push_back(common({left, top, right, bottom}, {0, 0, pixels.width, pixels.height}));
  }
  return boxes;
}
std::vector<PixelBox> boxes_of(const std::optional<BoxList>& list, const Pixels& pixels) {
  return list ? boxes_of(*list, pixels) : std::vector<PixelBox>{{0, 0, pixels.width, pixels.height}};
}

BoxList list_of(const std::vector<PixelBox>& boxes) {
  BoxList list;
  for (const PixelBox& box : boxes) list.emplace_back(box.left, box.top, box.right, box.bottom);
  return list;
}

/// An image or a mask, its left upper corner, and the colour (0..255) and opacity (0..1) of a mask.
using LayerTuple = std::tuple<nb::ndarray<const std::uint8_t, nb::device::cpu>, int, int, std::array<float, 3>, float>;

PictureLayer layer_of(const LayerTuple& given) {
  const auto& [array, left, top, color, alpha] = given;
  PictureLayer layer;
  layer.left = left;
  layer.top = top;
  if (array.ndim() < 2) throw nb::value_error("a layer is an image or a mask");
  layer.height = static_cast<int>(array.shape(0));
  layer.width = static_cast<int>(array.shape(1));
  const bool image = array.ndim() == 3;
  if (image && (array.shape(2) != 4 || array.stride(2) != 1)) throw nb::value_error("an image has four channels");
  if (layer.width > 1 && array.stride(1) != (image ? 4 : 1))
    throw nb::value_error("the pixels of a row must lie side by side");
  if (image) {
    layer.image = {const_cast<std::uint8_t*>(array.data()), static_cast<std::ptrdiff_t>(array.stride(0)), layer.width,
                   layer.height};
  } else {
    layer.mask = array.data();
    layer.stride = static_cast<std::ptrdiff_t>(array.stride(0));
    std::copy(color.begin(), color.end(), layer.color);
    layer.alpha = alpha;
  }
  return layer;
}

Ink ink_of(const InkTuple& color) {
  const auto level = [](double value) {
    return static_cast<std::uint8_t>(std::min(1.0, std::max(0.0, value)) * 255.0 + 0.5);
  };
  return {level(color[0]), level(color[1]), level(color[2]), level(color[3])};
}

const Vec2* points_of(const PointArray& points) { return reinterpret_cast<const Vec2*>(points.data()); }

LineStyle style_of(double width, const std::string& join, bool round_caps, const std::vector<double>& dashes = {}) {
  if (dashes.size() % 2 != 0 || std::any_of(dashes.begin(), dashes.end(), [](double d) { return !(d > 0.0); }))
    throw nb::value_error("dashes and gaps must be pairs of positive lengths");
  return {width, join == "round" ? Join::kRound : join == "bevel" ? Join::kBevel : Join::kMiter, round_caps, dashes};
}

void check_ranges(const RangeArray& ranges, std::size_t count) {
  for (std::size_t i = 0; i < ranges.shape(0); ++i) {
    const std::int64_t begin = ranges(i, 0), end = ranges(i, 1);
    if (begin < 0 || begin > end || static_cast<std::size_t>(end) > count)
      throw nb::value_error("ranges must lie within the points");
  }
}

/// A painter for pictures of one size, whose clip box lies within them.
struct BoundPainter {
  int width, height;
  Painter painter;

  Pixels own(const PixelArray& array) const {
    const Pixels pixels = pixels_of(array);
    if (pixels.width != width || pixels.height != height) throw nb::value_error("the picture has another size");
    return pixels;
  }
};

TextBox box_at(const double* corners) { return {corners[0], corners[1], corners[2], corners[3]}; }

nb::bytes bytes_of(const std::vector<std::uint8_t>& bytes) {
  return nb::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

nb::bytes rgb_rows(const ReadPixelArray& array) {
  const Pixels pixels = pixels_of(array);
  const std::size_t size = static_cast<std::size_t>(pixels.height) * (1 + 3 * static_cast<std::size_t>(pixels.width));
  nb::object out = nb::steal(PyBytes_FromStringAndSize(nullptr, static_cast<Py_ssize_t>(size)));
  if (!out.is_valid()) throw nb::python_error();
  write_rgb_rows(pixels, reinterpret_cast<std::uint8_t*>(PyBytes_AsString(out.ptr())));
  return nb::borrow<nb::bytes>(out);
}

nb::object box_or_none(const PixelBox& box) {
  if (box.left >= box.right || box.top >= box.bottom) return nb::none();
  return nb::make_tuple(box.left, box.top, box.right, box.bottom);
}

nb::object trails(const BoundState& state, const std::vector<int>& rows, const std::vector<double>& offsets,
                  TrailCut cut) {
  if (offsets.size() != rows.size()) throw nb::value_error("there must be one offset per row");
  if (cut.ages.size() < 2) throw nb::value_error("a trail has at least one piece");
  std::vector<Vec2> points;
  std::vector<std::int64_t> ranges;
  const State& s = state.state;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    state.check_row(rows[i]);
    if (!s.keep_history) throw nb::value_error("this state does not keep a history");
    const std::vector<double>& states = s.history[rows[i]];
    const std::size_t columns = 3 + static_cast<std::size_t>(s.extra_rows);
    const Pose& start = s.initial_pose[rows[i]];
    add_trail({states.data(), states.size() / columns, columns, {start.x, start.y}, start.theta, offsets[i]}, cut,
              points, ranges);
  }
  std::vector<double> places;
  for (const Vec2 p : points) places.insert(places.end(), {p.x, p.y});
  const std::size_t pieces = cut.ages.size() - 1;
  return nb::make_tuple(own(std::move(places), {points.size(), 2}), own(std::move(ranges), {rows.size(), pieces, 2}));
}

}  // namespace

void bind_pictures(nb::module_& m) {
  nb::class_<BoundPainter>(m, "Painter")
      .def(
          "__init__",
          [](BoundPainter* self, std::pair<int, int> size, std::array<int, 4> clip, std::array<double, 6> view) {
            const auto [width, height] = size;
            const auto [left, top, right, bottom] = clip;
            if (left < 0 || top < 0 || right > width || bottom > height)
              throw nb::value_error("the clip box must lie within the picture");
            const PixelBox box{left, top, std::max(left, right), std::max(top, bottom)};
            const PictureView seen{view[0], view[1], view[2], view[3], view[4], view[5]};
            new (self) BoundPainter{width, height, Painter(box, seen)};
          },
          nb::arg("size"), nb::arg("clip"), nb::arg("view"))
      .def(
          "glow",
          [](BoundPainter& self, const PixelArray& pixels, const PointArray& points, double x, double y, double reach,
             const InkTuple& fill) {
            self.painter.glow(self.own(pixels), points_of(points), points.shape(0), {x, y}, reach, ink_of(fill));
          },
          nb::arg("pixels"), nb::arg("points"), nb::arg("x"), nb::arg("y"), nb::arg("reach"), nb::arg("fill"))
      .def(
          "shapes",
          [](BoundPainter& self, const PixelArray& pixels, const PointArray& points, const RangeArray& ranges,
             const WidthArray& radii, const BothInksArray& inks, const WidthArray& widths, bool closed,
             const std::string& join, bool round_caps, const std::vector<double>& dashes) {
            const std::size_t count = ranges.shape(0);
            if (radii.shape(0) != count || inks.shape(0) != count || widths.shape(0) != count)
              throw nb::value_error("there must be one radius, one pair of colors and one width per shape");
            check_ranges(ranges, points.shape(0));
            const PictureShapes shapes{count,       points_of(points), ranges.data(), radii.data(),
                                       inks.data(), widths.data(),     closed};
            self.painter.shapes(self.own(pixels), shapes, style_of(0.0, join, round_caps, dashes));
          },
          nb::arg("pixels"), nb::arg("points"), nb::arg("ranges"), nb::arg("radii"), nb::arg("inks"), nb::arg("widths"),
          nb::arg("closed"), nb::arg("join"), nb::arg("round_caps"), nb::arg("dashes") = std::vector<double>{})
      .def(
          "beams",
          [](BoundPainter& self, const PixelArray& pixels, std::pair<double, double> origin, const PointArray& ends,
             const InkArray& inks, const WidthArray& widths) {
            const std::size_t count = ends.shape(0);
            if (inks.shape(0) != count || widths.shape(0) != count)
              throw nb::value_error("there must be one color and one width per beam");
            std::vector<Ink> colors;
            for (std::size_t i = 0; i < count; ++i) {
              const std::uint8_t* ink = inks.data() + 4 * i;
              colors.push_back({ink[0], ink[1], ink[2], ink[3]});
            }
            self.painter.beams(self.own(pixels), {origin.first, origin.second}, points_of(ends), count, colors.data(),
                               widths.data());
          },
          nb::arg("pixels"), nb::arg("origin"), nb::arg("ends"), nb::arg("inks"), nb::arg("widths"))
      .def(
          "image",
          [](BoundPainter& self, const PixelArray& pixels, const ReadPixelArray& above, int left, int top) {
            self.painter.image(self.own(pixels), pixels_of(above), left, top);
          },
          nb::arg("pixels"), nb::arg("above"), nb::arg("left"), nb::arg("top"))
      .def("take_boxes", [](BoundPainter& self) { return list_of(gathered(self.painter.take_boxes())); })
      .def(
          "line_mask",
          [](BoundPainter& self, const MaskArray& mask, const PointArray& points, double width, bool round_caps,
             bool snapped) {
            if (static_cast<int>(mask.shape(1)) != self.width || static_cast<int>(mask.shape(0)) != self.height ||
                mask.stride(1) != 1)
              throw nb::value_error("the mask has another size");
            return box_or_none(self.painter.line_mask(mask.data(), mask.stride(0), points_of(points), points.shape(0),
                                                      {width, Join::kRound, round_caps}, snapped));
          },
          nb::arg("mask"), nb::arg("points"), nb::arg("width"), nb::arg("round_caps"), nb::arg("snapped"));
  m.def(
      "compose",
      [](const PixelArray& array, const ReadPixelArray& ground, const BoxList& boxes,
         const std::vector<LayerTuple>& list) {
        const Pixels pixels = pixels_of(array), below = pixels_of(ground);
        check_same_size(pixels, below);
        std::vector<PictureLayer> layers;
        for (const LayerTuple& layer : list) layers.push_back(layer_of(layer));
        compose(pixels, below, merged(boxes_of(boxes, pixels)), layers);
      },
      nb::arg("pixels"), nb::arg("ground"), nb::arg("boxes"), nb::arg("layers"));
  m.def(
      "copy_boxes",
      [](const ReadPixelArray& from, const PixelArray& to, const BoxList& boxes) {
        const Pixels source = pixels_of(from), target = pixels_of(to);
        check_same_size(source, target);
        copy_boxes(source, target, boxes_of(boxes, target));
      },
      nb::arg("source"), nb::arg("target"), nb::arg("boxes"));
  m.def(
      "trails",
      [](const BoundState& state, const std::vector<int>& rows, const std::vector<double>& offsets,
         std::vector<std::int64_t> ages, std::int64_t longest,
         double least) { return trails(state, rows, offsets, {std::move(ages), longest, least}); },
      nb::arg("state"), nb::arg("rows"), nb::arg("offsets"), nb::arg("ages"), nb::arg("longest"), nb::arg("least"));
  m.def(
      "place_names",
      [](const nb::ndarray<const double, nb::shape<-1, 5>, nb::c_contig, nb::device::cpu>& wishes, double height,
         const std::array<double, 4>& inside, const BoxArray& taken, const BoxArray& walls, const PointArray& plans,
         const RangeArray& plan_ranges, const PointArray& trails) {
        check_ranges(plan_ranges, plans.shape(0));
        NameSurroundings around;
        around.inside = box_at(inside.data());
        around.height = height;
        for (std::size_t i = 0; i < taken.shape(0); ++i) around.taken.push_back(box_at(taken.data() + 4 * i));
        for (std::size_t i = 0; i < walls.shape(0); ++i) around.walls.push_back(box_at(walls.data() + 4 * i));
        for (std::size_t i = 0; i < plan_ranges.shape(0); ++i) {
          const auto begin = plan_ranges(i, 0), end = plan_ranges(i, 1);
          spread_points(points_of(plans) + begin, static_cast<std::size_t>(end - begin), around.plans);
        }
        around.trails.assign(points_of(trails), points_of(trails) + trails.shape(0));
        nb::list places;
        for (std::size_t i = 0; i < wishes.shape(0); ++i) {
          const double* wish = wishes.data() + 5 * i;
          const NamePlace place = place_name({{wish[0], wish[1]}, wish[2], wish[3], wish[4]}, around);
          places.append(nb::make_tuple(place.number, place.box.left, place.box.bottom, place.box.right, place.box.top));
        }
        return places;
      },
      nb::arg("wishes"), nb::arg("height"), nb::arg("inside"), nb::arg("taken"), nb::arg("walls"), nb::arg("plans"),
      nb::arg("plan_ranges"), nb::arg("trails"));
  m.def("rgb_rows", &rgb_rows, nb::arg("pixels"));
  m.def(
      "changed_box",
      [](const ReadPixelArray& before, const ReadPixelArray& after, const std::optional<BoxList>& boxes) {
        const Pixels old = pixels_of(before), now = pixels_of(after);
        check_same_size(old, now);
        return box_or_none(changed_box(old, now, boxes_of(boxes, now)));
      },
      nb::arg("before"), nb::arg("after"), nb::arg("boxes") = nb::none());
  m.def(
      "opaque_box", [](const ReadPixelArray& pixels) { return box_or_none(opaque_box(pixels_of(pixels))); },
      nb::arg("pixels"));
  nb::class_<Palette>(m, "Palette")
      .def(nb::init<std::vector<std::array<int, 3>>>(), nb::arg("colors"))
      .def(
          "encode",
          [](Palette& self, const ReadPixelArray& array, const std::optional<ReadPixelArray>& before,
             const BoxTuple& box, const std::optional<BoxList>& boxes, int transparent) {
            const Pixels pixels = pixels_of(array);
            Pixels old;
            if (before) check_same_size(pixels, old = pixels_of(*before));
            const GifData data = encode_gif(self, pixels, before ? &old : nullptr, boxes_of(BoxList{box}, pixels)[0],
                                            boxes_of(boxes, pixels), static_cast<std::uint8_t>(transparent));
            return nb::make_tuple(data.wrong, bytes_of(data.bytes));
          },
          nb::arg("pixels"), nb::arg("before").none(), nb::arg("box"), nb::arg("boxes").none(), nb::arg("transparent"));
}

}  // namespace irsim
