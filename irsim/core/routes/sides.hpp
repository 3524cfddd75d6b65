// The sides of the lines between an object and its moving neighbors. Two objects that both stay on their side until
// they stand cannot touch (Zhou, Wang, Bandyopadhyay, Schwager: Fast, on-line collision avoidance for dynamic vehicles
// using buffered Voronoi cells, 2017).
#pragma once

#include "collision/support.hpp"

namespace irsim {

/// The points p with dot(normal, p) <= offset, world frame.
struct Side {
  Vec2 normal;
  double offset;  // [m]
};

/// Find the widest strip between the convex hulls of two footprints.
///
/// Args:
///   normal: Unit vector across the strip, from `a` to `b`.
/// Returns: Its width [m]; negative if the hulls meet.
double widest_strip(const Footprint& a, const Footprint& b, Vec2& normal);

}  // namespace irsim
