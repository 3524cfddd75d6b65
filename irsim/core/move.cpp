// Limits and kinematics.
#include "phases.hpp"

namespace irsim {
void limit(const World& world, State& state, int w) {
  const int first = w * world.objects;
  for (int i = 0; i < world.objects; ++i) {
    Vec3& u = state.control[first + i];
    const bool idle = !world.behaves[i] && !state.given[first + i];  // stands still at once, as in IR-SIM
    if (world.is_static[i] || state.stopped[first + i] || idle) {
      u = {};
      continue;
    }
    const Vec3& wanted = state.command[first + i];
    Vec3 next;
    for (int c = 0; c < 3; ++c) {
      const double change = world.acce[i][c] * world.step_time;
      next[c] =
          clip(wanted[c], std::max(world.vel_min[i][c], u[c] - change), std::min(world.vel_max[i][c], u[c] + change));
    }
    u = next;
    with(world.drive[i], [&](const auto& drive) { u = constrain(drive, u); });
  }
}

void integrate(const World& world, State& state, int w) {
  const int first = w * world.objects;
  for (int i = 0; i < world.objects; ++i) {
    const int row = first + i;
    if (world.is_static[i] || state.stopped[row]) {
      state.twist[row] = {};
      continue;
    }
    with(world.drive[i], [&](const auto& drive) {
      Vec3 u = state.control[row];
      if (drive.noise) {
        const Vec3 sigma = deviation(drive, u);
        const auto normals =
            Draws(state.key(w), Stream::motion, world.number[i]).normals(static_cast<std::uint64_t>(state.count[w]));
        for (int c = 0; c < 3; ++c) u[c] += sigma[c] * normals[c];
      }
      run(drive, Motion{state.pose[row], &state.extra[static_cast<std::size_t>(row) * state.extra_rows],
                        state.twist[row], state.heading(row), u, world.step_time});
      Pose& pose = state.pose[row];
      pose.theta = into_range(pose.theta, world.angle_low[i], world.angle_high[i]);
    });
  }
}

void finish(const World& world, State& state, int w) {
  const int first = w * world.objects;
  ++state.count[w];
  for (int i = 0; i < world.objects; ++i) {
    const int row = first + i;
    state.given[row] = 0;
    if (!state.keep_history || world.is_static[i] || state.stopped[row]) continue;
    const Pose& pose = state.pose[row];
    std::vector<double>& track = state.history[row];
    const double* extra = &state.extra[static_cast<std::size_t>(row) * state.extra_rows];
    track.insert(track.end(), {pose.x, pose.y, pose.theta});
    track.insert(track.end(), extra, extra + state.extra_rows);
  }
}

}  // namespace irsim
