// Overlap of two convex pieces: its depth and place.
#pragma once

#include "geometry/vec.hpp"

namespace irsim {

/// A convex piece, world frame: a disc (count 1), a segment (2) or a counter-clockwise polygon.
struct Placed {
  const Vec2* vertices;
  const Vec2* normals;
  int count;
  double radius;
};

/// `normal` points from the second piece to the first. `depth` is the distance along it by which the first piece must
/// move to be free [m], negative across a gap. `point` is the middle of the overlap.
struct Overlap {
  Vec2 normal;
  double depth = -kInfinity;
  Vec2 point;
};

/// The overlap of two pieces. The depth is -infinity if they are more than `gap` apart.
Overlap overlap_of(const Placed& a, const Placed& b, double gap);

}  // namespace irsim
