// Objects as their bounding circles: what policies observe of others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

struct World;
struct State;

/// A bounding circle, world frame [m].
struct BoundingCircle {
  Vec2 centre;
  double radius;
};

/// The minimum bounding circles of all rows at their present poses.
std::vector<BoundingCircle> bounding_circles(const World& world, const State& state);

/// For each of `count` rows, the indices of up to `most` other objects of its world, nearest first by the distance
/// between bounding circles, then by index; -1 where there are fewer. An object counts if this distance is at most
/// `reach`, and if the row targets its role. Static objects count with `statics`, except unobstructed ones, maps and
/// the walls round a world.
std::vector<std::int32_t> nearest_objects(const World& world, const State& state,
                                          const std::vector<BoundingCircle>& circles, const std::int64_t* rows,
                                          std::size_t count, int most, double reach, bool statics);

}  // namespace irsim
