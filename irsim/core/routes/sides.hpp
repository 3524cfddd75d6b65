// The sides of the lines between an object and its moving neighbors. Two objects that both stay on their side until
// they stand cannot touch (Zhou, Wang, Bandyopadhyay, Schwager: Fast, on-line collision avoidance for dynamic vehicles
// using buffered Voronoi cells, 2017).
#pragma once

#include "collision/support.hpp"
#include "footprints/hulls.hpp"
#include "footprints/manoeuvres.hpp"

namespace irsim {

/// The points p with dot(normal, p) <= offset, world frame.
struct Side {
  Vec2 normal;
  double offset;  // [m]
};

/// Areas that movers of one world cover until they stand: scratch memory, by id.
struct StopHulls {
  Hulls all;
  std::vector<int> body, stop;  // hulls of the body, and of all its places if it brakes now; -1: unknown
  Manoeuvre way;                // that is looked at

  void clear(int objects) { all.clear(), body.assign(objects, -1), stop.assign(objects, -1); }
};

/// Find the widest strip between the convex hulls of two footprints.
///
/// Args:
///   normal: Unit vector across the strip, from `a` to `b`.
/// Returns: Its width [m]; negative if the hulls meet.
double widest_strip(const Footprint& a, const Footprint& b, Vec2& normal);

}  // namespace irsim
