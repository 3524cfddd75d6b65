// The way past walls: the direction in which an object gets round what stands between it and its goal.
//
// A behavior that only keeps its velocity free of collisions slows down in front of a flat wall and stands, because the
// allowed velocity nearest to "straight on" is "straight on, slower". So `rvo`, `sfm`, `orca` and `avocado` want to go
// along a tangent of what is in the way:
//  - A ring (rings.hpp) is in the way if the disc of the object, moved straight to the goal, meets one of its walls
//    before the goal and within `look`. A goal in front of a wall or a free gap therefore changes nothing.
//  - The turn to either side goes on until nothing is in the way. The side of the shorter way over the corner to the
//  goal
//    counts: on that way the other one never becomes shorter. In a tie it is the right one.
//  - If both sides lead away from the goal, half of the distance counts, and so on. In a room or a corridor whose walls
//    leave no way round, the wanted velocity stays as it is.
// `rvo` then also searches among velocities that meet nothing within this distance, see best_sample.
#pragma once

#include "decision.hpp"
#include "world/scene.hpp"

namespace irsim {

constexpr double kWallLook = 3.0;  // distance within which behaviors without an option for it pass walls [m]

/// See `past_walls`, for a world with walls.
Vec2 past_rings(const Decision& decision, int k, Vec2 position, double radius, double look, Vec2 wanted, bool all);

/// Turn the wanted velocity of object k of a decision past the walls that are in its way. Objects on a route, which
/// already leads past walls, keep it.
///
/// Args:
///   position, radius: The disc with which the object avoids walls, world frame [m].
///   look: Walls farther away are not in the way [m].
///   wanted: Velocity toward the goal, world frame [m/s].
///   all: Whether `unobstructed` lines are in the way, too.
inline Vec2 past_walls(const Decision& decision, int k, Vec2 position, double radius, double look, Vec2 wanted,
                       bool all) {
  if (decision.state.scenes[decision.w()].fixed->walls.rings.empty()) return wanted;
  return past_rings(decision, k, position, radius, look, wanted, all);
}

/// Whether a disc gets `look` [m] far in a direction without meeting a wall that object k sees.
///
/// Args:
///   position, radius: The disc, world frame [m].
///   ahead: Unit vector, world frame.
bool is_free_ahead(const Decision& decision, int k, Vec2 position, double radius, double look, Vec2 ahead);

}  // namespace irsim
