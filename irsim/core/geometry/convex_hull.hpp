// The convex hull of points.
#pragma once

#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

/// Replace points by the corners of their hull, counter-clockwise (Andrew's monotone chain). Points on a line leave the
/// two ends, equal points leave one. `hull` is scratch memory.
void make_hull(std::vector<Vec2>& points, std::vector<Vec2>& hull);

}  // namespace irsim
