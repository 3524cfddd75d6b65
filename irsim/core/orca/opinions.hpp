// The opinions that objects with `avocado` have of one another. They are a part of the state, so that every episode
// starts without opinions.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

/// The opinion that one object has of another that it has avoided.
struct Opinion {
  std::int64_t about = -1;  // World::number of the other object
  double opinion = 0.0;     // how much it gives way: -1 not at all, 0 as much as this object, 1 alone
  double attention = 0.0;   // 0 while no collision is ahead, 1 if one is near
  Vec2 velocity;            // of the other object in the last step [m/s]
  Vec2 change;              // change of the relative velocity that just avoided it then [m/s]
  std::int64_t seen = -1;   // step in which it was last considered
};
static_assert(sizeof(Opinion) == 2 * sizeof(std::int64_t) + 6 * sizeof(double), "snapshots hold its bytes: no padding");

/// The opinions of one object.
struct Opinions {
  std::int64_t step = -1;  // step in which they were formed
  // steps in which the object was last the mirror image of another one, and before that; -1: never
  std::int64_t tied = -1, tied_before = -1;
  std::vector<Opinion> of;  // of the objects considered in that step, nearest first; with memory of all before, too
};

}  // namespace irsim
