// How far two convex pieces overlap, and where.
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

/// `normal` points from the second piece to the first. `depth`: how far the first must move along it to be free [m];
/// negative across a gap. `point`: middle of what overlaps.
struct Overlap {
  Vec2 normal;
  double depth = -kInfinity;
  Vec2 point;
};

/// The overlap of two pieces; depth is -infinity once they are known to be more than `gap` apart.
Overlap overlap_of(const Placed& a, const Placed& b, double gap);

}  // namespace irsim
