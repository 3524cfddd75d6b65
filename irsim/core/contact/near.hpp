// Which bodies may meet in a step, and how far a turn carries their sides.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "contact/bodies.hpp"
#include "world/scene.hpp"
#include "world/world.hpp"

namespace irsim {

/// How far a turn [rad] carries the sides of a body out of the motion of its origin [m]: over no more than what is
/// outside of the disc that always stays in the body. Walls round the world have no radius.
inline double way_of_turn(const Shapes& shapes, const Bodies& bodies, int object, double turn) {
  const double outer = norm(shapes.centre[object]) + shapes.radius[object];
  return std::max(0.0, std::min(std::fabs(turn) * outer, outer - bodies.inner[object]));
}

/// List the pairs of objects a < b whose boxes meet and of which one can be pushed, sorted. Unobstructed ones meet
/// nothing.
///
/// Args:
///   at_fixed: Box of a moving object that is compared with fixed objects [m].
///   at_moving: That for other moving objects; these are left out without `movers`.
template <class AtFixed, class AtMoving>
void near_pairs(const World& world, Scene& scene, AtFixed&& at_fixed, AtMoving&& at_moving, bool movers,
                std::vector<std::pair<int, int>>& out) {
  out.clear();
  const auto add = [&](int i, int j) {
    if (world.unobstructed[i] || world.unobstructed[j]) return;
    if (world.dynamics[i].pushable || world.dynamics[j].pushable) add_pair(out, Pair{std::min(i, j), std::max(i, j)});
  };
  if (!world.fixed_objects.empty()) {
    for (const int i : world.moving) scene.fixed->grid.query(at_fixed(i), [&](int j) { add(i, j); });
  }
  if (movers && world.moving.size() > 1) scene.sweep.pairs(at_moving, add);
  std::sort(out.begin(), out.end());
}

}  // namespace irsim
