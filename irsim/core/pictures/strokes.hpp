// Outlines of discs, polygons and strokes, as areas that a raster covers.
#pragma once

#include <vector>

#include "pictures/raster.hpp"

namespace irsim {

enum class Join { kMiter, kRound, kBevel };

/// How a line is drawn.
struct LineStyle {
  double width = 1;  ///< [px]
  Join join = Join::kMiter;
  bool round_caps = false;
  std::vector<double> dashes{};  ///< lengths of dashes and of the gaps after them [px]; empty for a solid line
};

/// Collect a disc; `opacity`, above 0 and at most 1, tells how exact its rim has to be.
void add_disc(Raster& raster, Vec2 center, double radius, double opacity);

/// Collect the stroke of a circle.
void add_ring(Raster& raster, Vec2 center, double radius, double width, double opacity);

/// Collect the stroke of a line, or of a polygon if it is closed.
void add_stroke(Raster& raster, const std::vector<Vec2>& points, bool closed, const LineStyle& style);

/// Collect the dashes of a line; their pattern must have positive lengths, and as many dashes as gaps.
void add_dashes(Raster& raster, const std::vector<Vec2>& points, const LineStyle& style);

/// Move the corners of an outline whose edges all run along the axes to whole pixels, as Agg does, so that it is sharp.
/// Return whether it was such an outline.
bool snap(std::vector<Vec2>& points, bool closed, double width);

}  // namespace irsim
