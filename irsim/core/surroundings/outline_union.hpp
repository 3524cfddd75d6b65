// The outline of several polygons together.
#pragma once

#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

/// The outline of the union of simple counter-clockwise polygons that may overlap or touch: counter-clockwise rings,
/// and clockwise ones round its holes. If rounding errors leave no closed outline, the result is the polygons
/// themselves.
///
/// Method: every edge is cut where it meets other polygons; the pieces inside of one of them are dropped, and so are
/// the pieces on a common edge, except one if both polygons are on the same side. The remaining pieces are joined to
/// rings.
std::vector<std::vector<Vec2>> union_of(const std::vector<std::vector<Vec2>>& polygons);

}  // namespace irsim
