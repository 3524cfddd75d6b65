#include "pictures/painter.hpp"

namespace irsim {
namespace {

constexpr float kFullMask = 255.0f;
constexpr double kOpaque = 255.0;
constexpr double kGlowFall = 0.62;  ///< Share of its opacity that a glow loses up to its reach.
constexpr double kGlowRim = 0.1;    ///< Share of the reach over which its rest fades out at the end.

/// The raster of this thread, whose memory serves all painters.
Raster& raster_for(PixelBox clip) {
  thread_local Raster raster;
  raster.clip(clip);
  return raster;
}

constexpr double kBeside = 1.0;  ///< Pixels beside a shape that its raster has, too.

/// How far a stroke reaches beyond its line [px]; the tips of miters are the farthest.
double reach_of(const LineStyle& style) { return style.width / 2 * std::max(1.0, style.width) + kBeside; }

}  // namespace

void Painter::paint(Raster& raster, const Pixels& pixels, Ink ink) {
  raster.add_touched(boxes_);
  const float opacity = static_cast<float>(ink.alpha);
  raster.sweep([pixels, ink, opacity](int y, int x, float share) {
    const int alpha = static_cast<int>(share * opacity + 0.5f);
    lay_over(pixels.row(y) + kChannels * x, ink, alpha);
  });
}

void Painter::image(const Pixels& pixels, const Pixels& above, int left, int top) {
  lay_image(pixels, above, left, top);
  const PixelBox whole{0, 0, pixels.width, pixels.height};
  boxes_.push_back(common(whole, {left, top, left + above.width, top + above.height}));
}

Raster& Painter::raster_around(const Vec2* corners, std::size_t count, double margin) const {
  Vec2 low{kInfinity, kInfinity}, high{-kInfinity, -kInfinity};
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 p = corners[i];
    if (!(std::isfinite(p.x) && std::isfinite(p.y))) return raster_for(clip_);
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const auto pixel = [](double at, int from, int to) {
    return static_cast<int>(std::min(std::max(at, static_cast<double>(from)), static_cast<double>(to)));
  };
  const int left = pixel(std::floor(low.x - margin), clip_.left, clip_.right);
  const int top = pixel(std::floor(low.y - margin), clip_.top, clip_.bottom);
  const int right = pixel(std::ceil(high.x + margin), left, clip_.right);
  const int bottom = pixel(std::ceil(high.y + margin), top, clip_.bottom);
  return raster_for({left, top, right, bottom});
}

std::vector<Vec2> Painter::seen(const Vec2* points, std::size_t count) const {
  std::vector<Vec2> pixels;
  pixels.reserve(count);
  for (std::size_t i = 0; i < count; ++i) pixels.push_back(view_(points[i]));
  return pixels;
}

void Painter::circle(const Pixels& pixels, Vec2 center, double radius, Ink fill, Ink edge, double width) {
  const Vec2 middle = view_(center);
  const double reach = radius * scale();
  Raster& raster = raster_around(&middle, 1, reach + std::max(width, 0.0) + kBeside);
  if (fill.alpha > 0) {
    add_disc(raster, middle, reach, fill.alpha / kOpaque);
    paint(raster, pixels, fill);
  }
  if (edge.alpha > 0 && width > 0.0) {
    add_ring(raster, middle, reach, width, edge.alpha / kOpaque);
    paint(raster, pixels, edge);
  }
}

void Painter::polygon(const Pixels& pixels, const Vec2* points, std::size_t count, Ink fill, Ink edge,
                      const LineStyle& style) {
  std::vector<Vec2> corners = seen(points, count);
  const bool stroked = edge.alpha > 0 && style.width > 0.0;
  snap(corners, true, stroked ? style.width : 0.0);
  Raster& raster = raster_around(corners.data(), count, stroked ? reach_of(style) : kBeside);
  if (fill.alpha > 0) {
    raster.outline(corners.data(), corners.size());
    paint(raster, pixels, fill);
  }
  if (stroked) {
    add_stroke(raster, corners, true, style);
    paint(raster, pixels, edge);
  }
}

void Painter::glow(const Pixels& pixels, const Vec2* points, std::size_t count, Vec2 origin, double reach, Ink fill) {
  if (fill.alpha == 0 || !(reach > 0.0)) return;
  const std::vector<Vec2> corners = seen(points, count);
  Raster& raster = raster_around(corners.data(), count, kBeside);
  raster.outline(corners.data(), corners.size());
  const PixelBox box = raster.touched();
  const Vec2 middle = view_(origin);
  const double opacity = fill.alpha, per_pixel = 1.0 / (reach * scale());
  raster.sweep([&](int y, int x, float share) {
    const double away = std::hypot(x + 0.5 - middle.x, y + 0.5 - middle.y) * per_pixel;
    const double level = (1.0 - kGlowFall * away) * std::clamp((1.0 - away) / kGlowRim, 0.0, 1.0);
    lay_over(pixels.row(y) + kChannels * x, fill, static_cast<int>(share * opacity * level + 0.5));
  });
  if (!is_empty(box)) boxes_.push_back(box);
}

void Painter::line(const Pixels& pixels, const Vec2* points, std::size_t count, Ink edge, const LineStyle& style) {
  if (edge.alpha == 0 || !(style.width > 0.0)) return;
  std::vector<Vec2> corners = seen(points, count);
  snap(corners, false, style.width);
  Raster& raster = raster_around(corners.data(), count, reach_of(style));
  if (style.dashes.empty()) {
    add_stroke(raster, corners, false, style);
  } else {
    add_dashes(raster, corners, style);
  }
  paint(raster, pixels, edge);
}

void Painter::shapes(const Pixels& pixels, const PictureShapes& shapes, LineStyle style) {
  for (std::size_t i = 0; i < shapes.count; ++i) {
    const std::int64_t begin = shapes.ranges[2 * i], end = shapes.ranges[2 * i + 1];
    const Vec2* points = shapes.points + begin;
    const std::size_t count = static_cast<std::size_t>(end - begin);
    const std::uint8_t* ink = shapes.inks + 2 * kChannels * i;
    const Ink fill{ink[0], ink[1], ink[2], ink[3]}, edge{ink[4], ink[5], ink[6], ink[7]};
    style.width = shapes.widths[i];
    if (shapes.radii[i] >= 0.0) {
      if (count > 0) circle(pixels, points[0], shapes.radii[i], fill, edge, style.width);
    } else if (shapes.closed) {
      polygon(pixels, points, count, fill, edge, style);
    } else {
      line(pixels, points, count, edge, style);
    }
  }
}

void Painter::beams(const Pixels& pixels, Vec2 origin, const Vec2* ends, std::size_t count, const Ink* inks,
                    const double* widths) {
  const std::vector<PixelBox> before = take_boxes();
  Raster& raster = raster_for(clip_);
  PixelBox around{clip_.right, clip_.bottom, clip_.left, clip_.top};
  for (std::size_t i = 0; i < count; ++i) {
    const Ink ink = inks[i];
    const double width = widths[i];
    if (ink.alpha == 0 || !(width > 0.0)) continue;
    std::vector<Vec2>& both = beam_;
    both.assign({view_(origin), view_(ends[i])});
    snap(both, false, width);
    const Vec2 step = both[1] - both[0];
    const double length = norm(step);
    if (!(length > 0.0)) continue;
    const Vec2 across = Vec2{-step.y, step.x} * (width / 2 / length);
    const Vec2 corners[4] = {both[0] + across, both[0] - across, both[1] - across, both[1] + across};
    const float opacity = static_cast<float>(ink.alpha);
    const bool drawn = raster.sweep_convex(corners, 4, [&](int y, int x, float share) {
      lay_over(pixels.row(y) + kChannels * x, ink, static_cast<int>(share * opacity + 0.5f));
    });
    if (!drawn) {
      raster.outline(corners, 4);
      paint(raster, pixels, ink);
      continue;
    }
    for (const Vec2 corner : corners) {
      around.left = std::min(around.left, static_cast<int>(std::floor(corner.x)));
      around.right = std::max(around.right, static_cast<int>(std::ceil(corner.x)) + 1);
      around.top = std::min(around.top, static_cast<int>(std::floor(corner.y)));
      around.bottom = std::max(around.bottom, static_cast<int>(std::ceil(corner.y)) + 1);
    }
  }
  boxes_.push_back(common(around, clip_));
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
