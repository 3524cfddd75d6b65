// Ways round what stands between an object and its goal.
#pragma once

#include <cstdint>
#include <vector>

#include "footprints/hulls.hpp"

namespace irsim {

/// An object's memory of its way. It is a part of the state, so that every episode starts without one.
struct Detour {
  std::int64_t step = -1;     // step in which it was last used
  std::int64_t planned = -1;  // step in which a way was last searched; -1: the goal is straight ahead
  int blockers = 0;           // number of bodies that stood in the way then
  bool leads = false;         // whether the way leads to the goal, not only near it or toward it
  bool wide = false;          // whether it leaves room to turn on the spot: without it, there was no progress
  Vec2 goal;
  std::vector<Vec2> points;  // corners of the way; empty: straight to the goal
  std::size_t next = 0;      // the corner ahead
  Vec2 anchor;               // where it was in step `anchored`; it has stayed near since
  std::int64_t anchored = -1;
};

/// Bodies that stand, as the planner sees them.
struct Blocker {
  Hull hull;
  Vec2 centre;
  double radius;  // of the circle round the hull [m]
};

/// Memory of searches.
struct DetourMemory {
  struct Reach {
    Vec2 centre;
    double far2;  // square of the distance from which a blocker does not matter [m2]
  };
  std::vector<Reach> reaches;
  std::vector<float> price, cost;
  std::vector<std::int32_t> parent;
  std::vector<std::pair<float, std::int32_t>> heap;
  std::vector<Vec2> cells;
};

/// Whether a disc of this radius can move straight from a to b.
bool is_open(Vec2 a, Vec2 b, double radius, const std::vector<Blocker>& blockers);

/// Find a way of a disc of this radius to within `reach` [m] of the goal: the corners after `start`.
///
/// Args:
///   overlap: How far the disc may overlap something where there is no other way that is not much longer [m].
///
/// Returns: False without a way; the points then lead as near as possible.
bool find_detour(Vec2 start, Vec2 goal, double reach, double radius, double overlap,
                 const std::vector<Blocker>& blockers, DetourMemory& memory, std::vector<Vec2>& points);

}  // namespace irsim
