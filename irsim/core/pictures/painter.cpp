#include "pictures/painter.hpp"

namespace irsim {
namespace {

constexpr float kFullMask = 255.0f;

/// The raster of this thread, whose memory serves all painters.
Raster& raster_for(PixelBox clip) {
  thread_local Raster raster;
  raster.clip(clip);
  return raster;
}

}  // namespace

void Painter::paint(Raster& raster, const Pixels& pixels, Ink ink) {
  const PixelBox box = raster.touched();
  if (is_empty(box)) return raster.sweep([](int, int, float) {});
  const float opacity = static_cast<float>(ink.alpha);
  raster.sweep([&](int y, int x, float share) {
    const int alpha = static_cast<int>(share * opacity + 0.5f);
    lay_over(pixels.row(y) + kChannels * x, ink.red, ink.green, ink.blue, alpha);
  });
  boxes_.push_back(box);
}

void Painter::image(const Pixels& pixels, const Pixels& above, int left, int top) {
  lay_image(pixels, above, left, top);
  const PixelBox whole{0, 0, pixels.width, pixels.height};
  boxes_.push_back(common(whole, {left, top, left + above.width, top + above.height}));
}

std::vector<Vec2> Painter::seen(const Vec2* points, std::size_t count) const {
  std::vector<Vec2> pixels;
  pixels.reserve(count);
  for (std::size_t i = 0; i < count; ++i) pixels.push_back(view_(points[i]));
  return pixels;
}

void Painter::circle(const Pixels& pixels, Vec2 center, double radius, Ink fill, Ink edge, double width) {
  Raster& raster = raster_for(clip_);
  const Vec2 middle = view_(center);
  const double reach = radius * std::sqrt(std::fabs(view_.xx * view_.yy - view_.xy * view_.yx));
  if (fill.alpha > 0) {
    add_disc(raster, middle, reach);
    paint(raster, pixels, fill);
  }
  if (edge.alpha > 0 && width > 0.0) {
    add_ring(raster, middle, reach, width);
    paint(raster, pixels, edge);
  }
}

void Painter::polygon(const Pixels& pixels, const Vec2* points, std::size_t count, Ink fill, Ink edge,
                      const LineStyle& style) {
  Raster& raster = raster_for(clip_);
  std::vector<Vec2> corners = seen(points, count);
  const bool stroked = edge.alpha > 0 && style.width > 0.0;
  snap(corners, true, stroked ? style.width : 0.0);
  if (fill.alpha > 0) {
    raster.outline(corners.data(), corners.size());
    paint(raster, pixels, fill);
  }
  if (stroked) {
    add_stroke(raster, corners, true, style);
    paint(raster, pixels, edge);
  }
}

void Painter::line(const Pixels& pixels, const Vec2* points, std::size_t count, Ink edge, const LineStyle& style) {
  if (edge.alpha == 0 || !(style.width > 0.0)) return;
  Raster& raster = raster_for(clip_);
  std::vector<Vec2> corners = seen(points, count);
  snap(corners, false, style.width);
  add_stroke(raster, corners, false, style);
  paint(raster, pixels, edge);
}

void Painter::beams(const Pixels& pixels, Vec2 origin, const Vec2* ends, std::size_t count, const Ink* inks,
                    const double* widths) {
  const std::vector<PixelBox> before = take_boxes();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 both[2] = {origin, ends[i]};
    line(pixels, both, 2, inks[i], {widths[i], Join::kMiter, false});
  }
  boxes_ = merged(boxes_);
  boxes_.insert(boxes_.end(), before.begin(), before.end());
}

PixelBox Painter::line_mask(std::uint8_t* mask, std::ptrdiff_t stride, const Vec2* points, std::size_t count,
                            const LineStyle& style, bool snapped) {
  Raster& raster = raster_for(clip_);
  std::vector<Vec2> corners = seen(points, count);
  if (snapped) snap(corners, false, style.width);
  add_stroke(raster, corners, false, style);
  const PixelBox box = raster.touched();
  raster.sweep([&](int y, int x, float share) {
    std::uint8_t& level = mask[y * stride + x];
    level = std::max(level, static_cast<std::uint8_t>(share * kFullMask + 0.5f));
  });
  return box;
}

}  // namespace irsim
