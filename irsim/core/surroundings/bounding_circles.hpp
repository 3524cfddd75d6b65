// Objects as their bounding circles, as policies observe them.
#pragma once

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

/// The minimum bounding circles of the objects of world w at their present poses.
void bounding_circles(const World& world, const State& state, int w, std::vector<BoundingCircle>& out);

/// The nearest objects of a row and the gaps to them [m].
struct NearestRows {
  std::vector<int> object;
  std::vector<double> gap;
};

/// The indices of up to `most` other objects of the world of a row, nearest first by the distance between bounding
/// circles, then by index. An object counts if this distance is at most `reach`, and if the row targets its role.
/// Static objects count with `statics`, except unobstructed ones, maps and the walls round a world. `circles` belong to
/// this world.
void nearest_objects(const World& world, const State& state, const std::vector<BoundingCircle>& circles, int row,
                     int most, double reach, bool statics, NearestRows& out);

}  // namespace irsim
