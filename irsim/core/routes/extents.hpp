// How much space a footprint takes up about the origin of its object.
#pragma once

#include "geometry/shapes.hpp"

namespace irsim {

/// Distances of a footprint from its origin [m].
struct Extent {
  double reach = 0.0;  // of its farthest point
  double side = 0.0;   // of its farthest point to the left or right
};
Extent extent_of(const Shapes& shapes, int object);

/// Radius [m] of the largest disc about the origin within one of the polygons or circles of a footprint, which covers
/// this disc at every heading. A polygon counts only if the origin is on the inner side of all its edges.
double inner_radius(const Shapes& shapes, int object);

/// How far a footprint reaches where a turn about its origin changes what it covers: 0 for a disc about it [m].
double sweeping_reach(const Shapes& shapes, int object);

}  // namespace irsim
