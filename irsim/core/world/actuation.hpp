// Between a command and the control that a drive executes: period, dead time, resolution, limits, lag, dead band,
// noise.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "fields.hpp"
#include "geometry/vec.hpp"

namespace irsim {

/// The actuators of an object as Python gives them: numbers for each control, in its unit.
struct Actuation {
  double command_period;             // time for which a command is held [s]; 0: a step
  std::array<double, 3> delay;       // time from a command to its effect [s]
  std::array<double, 3> resolution;  // commands are rounded to its multiples; 0: they are not
  std::array<double, 3> jerk;        // largest change of the rate of change [per s^2], may be infinite
  std::array<double, 3> lag;         // time constant [s]
  std::array<double, 3> dead_band;   // smaller controls are executed as 0
  std::array<double, 3> noise;       // standard deviation of the executed control
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using A = Actuation;
    return visit(field("command_period", &A::command_period), field("delay", &A::delay),
                 field("resolution", &A::resolution), field("jerk", &A::jerk), field("lag", &A::lag),
                 field("dead_band", &A::dead_band), field("noise", &A::noise));
  }
};

/// The actuators of one object, with times as numbers of steps.
struct Actuators {
  Actuation options;
  double period = 0.0;     // steps for which a command is held
  Vec3 delay;              // steps from a command to its effect
  bool noisy = false;      // whether any control is
  std::size_t first = 0;   // slot of its queue among the queues of a world
  std::int64_t slots = 0;  // commands that its queue holds; 0 without a dead time
};

/// The memory of the actuators of one row from step to step.
struct Actuated {
  Vec3 held;      // command of the present period
  Vec3 setpoint;  // control within its limits, before the lag
  Vec3 rate;      // its change in the last step [per s]
  Vec3 lagged;    // control after the lag
};

struct World;
struct State;

/// The control that a row executes in this step, from the command for it.
Vec3 actuate(const World& world, State& state, int row, const Vec3& command);
/// Let the actuators of a row be at rest at a control, as if it had been commanded for long.
void rest_at(const World& world, State& state, int row, const Vec3& control);

}  // namespace irsim
