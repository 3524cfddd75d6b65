// Ties with what stands: the half-plane of a circle exactly ahead only slows an object down, so that it would stand
// before it for ever. It then wants to pass on its right. Where the circle is not exactly ahead nothing changes.
#pragma once

#include "orca/crowd.hpp"
#include "orca/settings.hpp"
#include "world/state.hpp"
#include "world/world.hpp"

namespace irsim {

constexpr double kParallelSine = 1e-9;  // a smaller sine of an angle between two lines is a rounding error

/// Whether the behavior of `viewer` targets the role of an object of another group.
inline bool targets_role(const World& world, int viewer, int other) {
  const int wanted = world.target_roles[viewer];
  return wanted == 0 || (wanted == 1) == (world.is_robot[other] != 0);
}

/// Whether `velocity` is the wanted one, only slower.
inline bool is_slower(Vec2 velocity, Vec2 wanted) {
  const double most = squared(wanted), along = dot(velocity, wanted);
  return along >= 0.0 && along < (1.0 - kParallelSine) * most &&
         std::fabs(cross(wanted, velocity)) <= kParallelSine * most;
}

/// Whether a circle that stands is exactly ahead, before the goal: its half-plane only slows the object down.
///
/// Args:
///   self: The object, one of the movers of world w, whose neighbors are known.
///   ahead: Unit vector of the wanted velocity.
///   speed: At which it wants to move [m/s].
///   far: Distance of the goal [m].
bool stands_ahead(const OrcaSettings& options, const World& world, const State& state, int w, int self, Vec2 ahead,
                  double speed, double far, const OrcaCrowd& all);

}  // namespace irsim
