// Triangles of a simple polygon.
#pragma once

#include <array>
#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

using Triangle = std::array<int, 3>;  // vertices of the ring, counter-clockwise

/// Constrained Delaunay triangulation of a simple counter-clockwise ring: ears are cut off, then edges inside are
/// flipped while that makes the smallest angles larger (Lawson 1977).
std::vector<Triangle> triangulate(const std::vector<Vec2>& ring);

}  // namespace irsim
