#include "contact/parts.hpp"

#include <algorithm>

#include "contact/hold.hpp"
#include "phases.hpp"
#include "phases/strides.hpp"

namespace irsim {
namespace {

// Of the parts of a step together. The last part has as many as a whole step.
constexpr int kFewSweeps = 8, kExtraSweeps = 160;

/// Largest speed of a point of a moving object [m/s].
double fastest(const World& world, const State& state, int w) {
  double most = 0.0;
  for (const int i : world.moving) {
    const Vec3& twist = state.twist[w * world.objects + i];
    const double speed = norm({twist[0], twist[1]}) + std::fabs(twist[2]) * state.scenes[w].shapes->radius[i];
    if (std::isfinite(speed)) most = std::max(most, speed);
  }
  return most;
}

}  // namespace

void push_in_parts(const World& world, State& state, int w, Workspace& work, const Resolution& options, int parts) {
  Scene& scene = state.scenes[w];
  ContactBuffers& buffers = work.contacts;
  const int first = w * world.objects;
  buffers.merged.clear();
  buffers.drift.assign(world.objects, Vec3{});
  buffers.end.assign(&state.pose[first], &state.pose[first] + world.objects);
  std::vector<Stride>& strides = buffers.strides;
  strides.clear();
  buffers.twists.resize(world.objects);
  for (const int i : world.moving) {
    strides.push_back(stride_of(world, state, w, i));
    state.pose[first + i] = state.before[first + i];
  }
  std::vector<std::uint8_t>& touched = buffers.touched;
  touched.assign(world.objects, 0);
  const auto collect = [&](double share) {
    for (const Contact& contact : scene.contacts) touched[contact.a] = touched[contact.b] = 1;
    merge_contacts(buffers.merged, scene.contacts, share);
  };
  // Overlaps left by the last step are resolved as fast as in a step that is not divided.
  Resolution some{std::max(kFewSweeps, options.sweeps / parts), kExtraSweeps / parts, options.slop, world.step_time};
  buffers.from.clear(), buffers.turned.assign(world.moving.size(), 0.0);
  for (const int i : world.moving) buffers.from.push_back(state.pose[first + i]);
  push_and_hold(world, state, w, work, some, {buffers.from, buffers.turned, parts});
  collect(0.0);
  some.step_time = options.step_time, some.share = 1.0 / parts;
  for (int part = 0; part < parts; ++part) {
    buffers.from.clear(), buffers.turned.clear();
    for (std::size_t m = 0; m < world.moving.size(); ++m) {
      const int i = world.moving[m];
      const double begin = static_cast<double>(part) / parts, end = static_cast<double>(part + 1) / parts;
      const Pose from = strides[m].at(begin), to = strides[m].at(end);
      Pose& pose = state.pose[first + i];
      const Vec3& drift = buffers.drift[i];
      buffers.from.push_back(pose), buffers.turned.push_back(to.theta - from.theta + drift[2]);
      pose.x += to.x - from.x + drift[0], pose.y += to.y - from.y + drift[1];
      pose.theta =
          into_range(wrap(pose.theta + (to.theta - from.theta) + drift[2]), world.angle_low[i], world.angle_high[i]);
      buffers.twists[i] = state.twist[first + i];
    }
    some.fastest = fastest(world, state, w);
    if (part + 1 == parts) some.sweeps = options.sweeps, some.extra_sweeps = options.extra_sweeps;
    push_and_hold(world, state, w, work, some, {buffers.from, buffers.turned, parts});
    for (const int i : world.moving) {
      for (int c = 0; c < 3; ++c)
        buffers.drift[i][c] += (state.twist[first + i][c] - buffers.twists[i][c]) * options.step_time;
    }
    collect(1.0 / parts);
  }
  std::swap(scene.contacts, buffers.merged);
  for (const int i : world.moving) {
    if (!touched[i]) state.pose[first + i] = buffers.end[i];
  }
  scene.bent.assign(touched.begin(), touched.end());
}

}  // namespace irsim
