// The actuators of an object, in a fixed order: hold, dead time, resolution, limits, lag, dead band, noise.
#include <algorithm>
#include <cmath>

#include "drive.hpp"
#include "world/state.hpp"
#include "world/world.hpp"

namespace irsim {
namespace {

constexpr double kStepRounding = 1e-9;  // of a time as a number of steps

/// Number of the command period in which a step lies; each step has its own where commands are not held.
std::int64_t period_of(const Actuators& actuators, std::int64_t step) {
  if (!(actuators.period > 1.0)) return step;
  return static_cast<std::int64_t>(std::floor(static_cast<double>(step) / actuators.period + kStepRounding));
}

/// The commands of a row that wait for their dead time.
Vec3* queue_of(const World& world, State& state, int row) {
  const std::size_t w = row / world.objects;
  return state.queue.data() + w * world.queue_slots + world.actuators[row % world.objects].first;
}

/// The command of `delay` steps ago, between two steps on the line between their commands.
double delayed(const Vec3* queue, std::int64_t slots, std::int64_t step, int control, double delay) {
  std::int64_t whole = static_cast<std::int64_t>(std::floor(delay + kStepRounding));
  double part = delay - static_cast<double>(whole);
  if (std::fabs(part) < kStepRounding) part = 0.0;
  const auto at = [&](std::int64_t ago) { return queue[(step + slots - ago) % slots][control]; };
  return part == 0.0 ? at(whole) : at(whole) + (at(whole + 1) - at(whole)) * part;
}

/// The rate of change with which a control approaches its target, so that neither the rate jumps by more than the jerk
/// allows nor the control passes its target: `speed_to_stop_within`, for rates instead of speeds.
double approach(double left, double rate, double most, double jerk, double dt) {
  const double toward = std::min(most, speed_to_stop_within(std::fabs(left), jerk, dt));
  return clip(std::copysign(toward, left), rate - jerk * dt, rate + jerk * dt);
}

/// The setpoint of a row that is limited in speed, acceleration and jerk.
Vec3 within_limits(const World& world, const State& state, int row, const Actuators& actuators, const Vec3& wanted) {
  const Actuated& now = state.actuated[row];
  const int object = row % world.objects;
  const double dt = world.step_time;
  Vec3 target, next;
  for (int c = 0; c < 3; ++c) target[c] = clip(wanted[c], state.vel_min[row][c], state.vel_max[row][c]);
  with(world.drive[object], [&](const auto& drive) { target = constrain(drive, target); });
  for (int c = 0; c < 3; ++c) {
    const double from = now.setpoint[c], left = target[c] - from, acce = state.acce[row][c];
    if (std::isinf(actuators.options.jerk[c])) {
      next[c] = clip(target[c], from - acce * dt, from + acce * dt);
    } else {
      const double rate = approach(left, now.rate[c], acce, actuators.options.jerk[c], dt);
      next[c] = rate == left / dt ? target[c] : from + rate * dt;
    }
  }
  with(world.drive[object], [&](const auto& drive) { next = constrain(drive, next); });
  return next;
}

void add_noise(const World& world, const State& state, int row, const Actuators& actuators, Vec3& control) {
  if (control[0] == 0.0 && control[1] == 0.0 && control[2] == 0.0) return;  // what stands does not tremble
  const int w = row / world.objects;
  const Draws draws(state.key(w), Stream::actuation, world.number[row % world.objects]);
  const auto normals = draws.normals(static_cast<std::uint64_t>(period_of(actuators, state.count[w])));
  for (int c = 0; c < 3; ++c) control[c] += actuators.options.noise[c] * normals[c];
}

}  // namespace

Vec3 actuate(const World& world, State& state, int row, const Vec3& command) {
  const Actuators& actuators = world.actuators[row % world.objects];
  const Actuation& options = actuators.options;
  Actuated& now = state.actuated[row];
  const std::int64_t step = state.count[row / world.objects];
  if (step == 0 || period_of(actuators, step) != period_of(actuators, step - 1)) now.held = command;
  Vec3 wanted = now.held;
  if (actuators.slots > 0) {
    Vec3* queue = queue_of(world, state, row);
    queue[step % actuators.slots] = now.held;
    for (int c = 0; c < 3; ++c)
      wanted[c] = delayed(queue, actuators.slots, step, c, actuators.delay[c] * state.delay_scale[row]);
  }
  for (int c = 0; c < 3; ++c) {
    const double unit = options.resolution[c];
    if (unit > 0.0) wanted[c] = std::round(wanted[c] / unit) * unit;
  }
  const Vec3 before = now.setpoint;
  now.setpoint = within_limits(world, state, row, actuators, wanted);
  Vec3 executed;
  for (int c = 0; c < 3; ++c) {
    now.rate[c] = (now.setpoint[c] - before[c]) / world.step_time;
    const double lag = options.lag[c] * state.lag_scale[row];
    now.lagged[c] = lag > 0.0 ? now.lagged[c] - (now.setpoint[c] - now.lagged[c]) * std::expm1(-world.step_time / lag)
                              : now.setpoint[c];
    executed[c] = std::fabs(now.lagged[c]) < options.dead_band[c] ? 0.0 : now.lagged[c];
  }
  if (actuators.noisy) add_noise(world, state, row, actuators, executed);
  return executed;
}

void rest_at(const World& world, State& state, int row, const Vec3& control) {
  state.actuated[row] = {control, control, {}, control};
  const std::int64_t slots = world.actuators[row % world.objects].slots;
  if (slots > 0) std::fill_n(queue_of(world, state, row), slots, control);
}

}  // namespace irsim
