// Paints the shapes of a scene into pixels, as Matplotlib would draw them with Agg.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "pictures/strokes.hpp"

namespace irsim {

/// From world coordinates to pixels: x' = xx x + xy y + x0, y' = yx x + yy y + y0, y' downwards.
struct PictureView {
  double xx = 1, xy = 0, x0 = 0, yx = 0, yy = 1, y0 = 0;

  Vec2 operator()(Vec2 p) const { return {xx * p.x + xy * p.y + x0, yx * p.x + yy * p.y + y0}; }
};

/// Shapes of one kind in common arrays. Shape i has the points from begins(i) on, up to ends(i); if radii[i] >= 0, it
/// is the circle of this radius about the first of them, else a polygon if they are closed, else a line.
struct PictureShapes {
  std::size_t count = 0;
  const Vec2* points = nullptr;
  const std::int64_t* ranges = nullptr;  ///< (count, 2) begin and end
  const double* radii = nullptr;
  const std::uint8_t* inks = nullptr;  ///< (count, 2, 4) of fill and edge
  const double* widths = nullptr;      ///< of edges [px]
  bool closed = false;
};

/// Paints shapes in world coordinates; a shape has a fill and a stroke, of which either may be transparent.
class Painter {
 public:
  /// Paint into this part of pictures, seen like this.
  Painter(PixelBox clip, const PictureView& view) : clip_(clip), view_(view) {}

  void circle(const Pixels& pixels, Vec2 center, double radius, Ink fill, Ink edge, double width);
  void polygon(const Pixels& pixels, const Vec2* points, std::size_t count, Ink fill, Ink edge, const LineStyle& style);

  /// Paint a polygon that is bright at `origin`, paler with the distance, and ends softly at the distance `reach`.
  void glow(const Pixels& pixels, const Vec2* points, std::size_t count, Vec2 origin, double reach, Ink fill);

  void line(const Pixels& pixels, const Vec2* points, std::size_t count, Ink edge, const LineStyle& style);

  /// Paint shapes, one over the other; `style` has the joins, caps and dashes of all of them.
  void shapes(const Pixels& pixels, const PictureShapes& shapes, LineStyle style);

  /// Paint straight lines from `origin` to the `ends`, one over the other.
  void beams(const Pixels& pixels, Vec2 origin, const Vec2* ends, std::size_t count, const Ink* inks,
             const double* widths);

  /// Lay a picture over another, with its left upper corner at (left, top); the clip box does not cut it.
  void image(const Pixels& pixels, const Pixels& above, int left, int top);

  /// The boxes that were painted since this was last asked.
  std::vector<PixelBox> take_boxes() { return std::exchange(boxes_, {}); }

  /// Raise the levels of a mask (height, width) to the levels of a line; return the box that was touched.
  ///
  /// `snapped` lines that run along the axes of the picture are drawn at whole pixels.
  PixelBox line_mask(std::uint8_t* mask, std::ptrdiff_t stride, const Vec2* points, std::size_t count,
                     const LineStyle& style, bool snapped);

 private:
  /// The raster of this thread, only as large as what these corners and a margin need, so that it stays in the cache.
  Raster& raster_around(const Vec2* corners, std::size_t count, double margin) const;
  std::vector<Vec2> seen(const Vec2* points, std::size_t count) const;
  double scale() const { return std::sqrt(std::fabs(view_.xx * view_.yy - view_.xy * view_.yx)); }
  void paint(Raster& raster, const Pixels& pixels, Ink ink);

  PixelBox clip_;
  PictureView view_;
  std::vector<PixelBox> boxes_;
  std::vector<Vec2> beam_;
};

}  // namespace irsim
