// Objects are moved by what they touch.
#pragma once

#include <utility>
#include <vector>

#include "world/state.hpp"
#include "world/world.hpp"

namespace irsim {

/// Shift a row by `by` [m, world frame] and turn it by `turn` [rad] about its centroid (body frame).
void shift(const World& world, State& state, int row, Vec2 by, double turn, Vec2 centroid);
/// Change the velocity of a row: world frame [m/s] and yaw rate [rad/s]. Its control takes what the drive has a
/// component for.
void push(const World& world, State& state, int row, Vec2 change, double yaw_rate);

struct Resolution {
  int sweeps;        // at most
  int extra_sweeps;  // more of them while somebody is left visibly inside another
  double slop;       // left between things that were pushed apart [m]
  double step_time;  // [s]
};

/// Push apart these pairs of object ids, or all that may meet.
void push_apart(const World& world, State& state, int w, Workspace& work, const Resolution& options,
                const std::vector<std::pair<int, int>>* pairs);

}  // namespace irsim
