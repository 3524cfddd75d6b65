// Triangulation of simple polygons.
#pragma once

#include <array>
#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

using Triangle = std::array<int, 3>;  // indices of vertices of the ring, counter-clockwise

/// Constrained Delaunay triangulation of a simple counter-clockwise ring: ears are cut off, then inner edges are
/// flipped while that makes the smallest angles larger (Lawson 1977).
std::vector<Triangle> triangulate(const std::vector<Vec2>& ring);

}  // namespace irsim
