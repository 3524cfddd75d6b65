// `arrive_mode: state`: drives that turn on the spot face the way that their goal gives.
#pragma once

#include "world/state.hpp"
#include "world/world.hpp"

namespace irsim {

/// Whether an object must reach a heading at its present goal, and has a drive that turns on the spot.
bool turns_at_goal(const World& world, const State& state, int row, int object);

/// Largest speed from which an object can stop at its goal [m/s]; infinite without a limit of its acceleration.
double speed_to_goal(const World& world, const State& state, int row);

/// The yaw rate with which the turn of an object at its goal ends at the heading of the goal [rad/s].
double yaw_rate_to_goal(const World& world, const State& state, int row, int object);

/// Let an object that must reach a heading at its goal turn to it there.
///
/// `diff` brakes before its goal, stands while it turns, and stays there, unless its behavior avoids an object that
/// would otherwise run into it soon. `omni_angular` moves as its behavior wants, and turns where the behavior rests or
/// oscillates.
///
/// Args:
///   control: The wish of the object's behavior; changed in place.
void face_goal(const World& world, const State& state, int row, int object, Vec3& control);

}  // namespace irsim
