// Displacements and changes of velocity of objects by contacts.
#pragma once

#include <utility>
#include <vector>

#include "world/state.hpp"
#include "world/world.hpp"

namespace irsim {

/// Shift a row by `by` [m, world frame] and turn it by `turn` [rad] about its centroid (body frame).
void shift(const World& world, State& state, int row, Vec2 by, double turn, Vec2 centroid);
/// Change the velocity (world frame [m/s]) and yaw rate [rad/s] of a row. Its control changes in those components that
/// its drive has.
void push(const World& world, State& state, int row, Vec2 change, double yaw_rate);

/// How contacts are resolved.
struct Resolution {
  int sweeps;        // maximum number of sweeps
  int extra_sweeps;  // maximum number of further sweeps while bodies visibly overlap
  double slop;       // gap left between bodies that were pushed apart [m]
  double step_time;  // [s]
  // In parts of a step: no contact makes a body faster than the fastest one [m/s]. The rest of older overlaps
  // would, because it goes in the time of a part; only this share of it counts.
  double fastest = kInfinity;
  double share = 1.0;
};

/// Push these pairs of objects apart, or all objects that may meet if `pairs` is null.
void push_apart(const World& world, State& state, int w, Workspace& work, const Resolution& options,
                const std::vector<std::pair<int, int>>* pairs);

}  // namespace irsim
