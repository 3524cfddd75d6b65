// Limits and kinematics.
#include <algorithm>

#include "contact/respond.hpp"
#include "phases.hpp"

namespace irsim {

namespace {

/// The executed control of a moving object whose commands pass through actuators. Without a command it is told to stop.
void limit_actuated(const World& world, State& state, int row) {
  const bool waits = state.waits(row), commanded = world.behaves[row % world.objects] || state.given[row];
  if (waits) rest_at(world, state, row, {});
  const Vec3 u = waits ? Vec3{} : actuate(world, state, row, commanded ? state.command[row] : Vec3{});
  state.control[row] = world.collision_mode == kContact ? respond(world, state, row, u) : u;
}

}  // namespace

void limit(const World& world, State& state, int w, int object) {
  const int row = w * world.objects + object;
  Vec3& u = state.control[row];
  if (world.is_static[object] || state.stopped[row]) {
    u = {};
    if (world.has_actuators[object]) rest_at(world, state, row, {});
    return;
  }
  if (world.has_actuators[object]) return limit_actuated(world, state, row);
  if (state.waits(row)) {
    u = world.collision_mode == kContact ? respond(world, state, row, {}) : Vec3{};
    return;
  }
  if (!world.behaves[object] && !state.given[row]) {
    u = without_command(world, state, row);
    return;
  }
  const Vec3& wanted = state.command[row];
  Vec3 next;
  for (int c = 0; c < 3; ++c) {
    const double change = state.acce[row][c] * world.step_time;
    next[c] =
        clip(wanted[c], std::max(state.vel_min[row][c], u[c] - change), std::min(state.vel_max[row][c], u[c] + change));
  }
  u = next;
  with(world.drive[object], [&](const auto& drive) { u = constrain(drive, u); });
  if (world.collision_mode == kContact) u = respond(world, state, row, u);
}

void limit(const World& world, State& state, int w) {
  for (int i = 0; i < world.objects; ++i) limit(world, state, w, i);
}

void integrate(const World& world, State& state, int w, int object) {
  const int row = w * world.objects + object;
  if (world.is_static[object] || state.stopped[row]) {
    state.twist[row] = {};
    with(world.drive[object],
         [&](const auto& drive) { rest(drive, &state.extra[static_cast<std::size_t>(row) * state.extra_rows]); });
    return;
  }
  if (!world.dynamics[object].driven) return coast(world, state, row);
  const bool waits = state.waits(row);
  if (waits && world.collision_mode != kContact) {  // nothing can push it
    state.twist[row] = {};
    return;
  }
  with(world.drive[object], [&](const auto& drive) {
    Vec3 u = state.control[row];
    if (drive.noise && !waits) {
      const Vec3 sigma = deviation(drive, u);
      const Draws draws(state.key(w), Stream::motion, world.number[object]);
      const auto normals = draws.normals(static_cast<std::uint64_t>(state.count[w]));
      for (int c = 0; c < 3; ++c) u[c] += sigma[c] * normals[c];
    }
    if (!world.zones.grounds.empty()) feel_ground(world, state, row);
    run(drive, Motion{state.pose[row], &state.extra[static_cast<std::size_t>(row) * state.extra_rows], state.twist[row],
                      state.heading(row), u, world.step_time, world.integration, state.footing(world, row),
                      world.wheels_slip ? &state.underfoot[row].unmoved : nullptr});
    Pose& pose = state.pose[row];
    pose.theta = into_range(pose.theta, world.angle_low[object], world.angle_high[object]);
  });
}

void integrate(const World& world, State& state, int w) {
  const int first = w * world.objects;
  std::copy_n(&state.pose[first], world.objects, &state.before[first]);
  state.scenes[w].in_motion = true;
  for (int i = 0; i < world.objects; ++i) integrate(world, state, w, i);
}

void remember(State& state, int row) {
  if (!state.keep_history) return;
  const Pose& pose = state.pose[row];
  std::vector<double>& track = state.history[row];
  const double* extra = &state.extra[static_cast<std::size_t>(row) * state.extra_rows];
  track.push_back(pose.x);
  track.push_back(pose.y);
  track.push_back(pose.theta);
  for (int k = 0; k < state.extra_rows; ++k) track.push_back(extra[k]);
}

void finish(const World& world, State& state, int w) {
  const int first = w * world.objects;
  ++state.count[w];
  if (!world.leavers.empty()) vanish(world, state, w);
  if (!world.latecomers.empty()) appear(world, state, w);
  for (int i = 0; i < world.objects; ++i) {
    const int row = first + i;
    state.given[row] = 0;
    const bool held = state.stopped[row] && world.collision_mode != kContact;  // others can push a robot that arrived
    if (!world.is_static[i] && !held && !state.absent(row)) remember(state, row);
  }
}

}  // namespace irsim
