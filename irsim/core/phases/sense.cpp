// Every sensor takes its scan, and robots clear the fog where they see.
#include "phases.hpp"
#include "sensing.hpp"
#include "sensing/fog.hpp"
#include "world/features.hpp"

namespace irsim {

void scan(const World& world, State& state, int w, const Scan& sensor, const Pose& pose, Vec2 direction,
          Workspace& work, bool sweeping) {
  static const std::vector<Mount> kAtOnce;
  const Mount& mount = sensor.mount;
  const std::size_t at = static_cast<std::size_t>(w) * world.beams_per_world + mount.first;
  const std::size_t velocities = static_cast<std::size_t>(w) * world.velocities_per_world + mount.first_velocity;
  const Sensing sensing{
      world,
      state,
      w,
      mount,
      pose,
      direction,
      state.ranges.data + at,
      state.hits.data + at,
      state.valid.data + at,
      state.velocities.data + velocities,
      state.readings.data + static_cast<std::size_t>(w) * world.readings_per_world + mount.first_reading,
      state.memory.data() + static_cast<std::size_t>(w) * world.memory_per_world + mount.first_memory,
      work.velocities.data(),
      work.beams,
      work.blockers,
      sweeping ? sensor.parts : kAtOnce,
      work.ghost,
      0,
      mount.count};
  with(sensor.sensor, [&](const auto& options) { run(options, sensing); });
}

void update_object_velocities(const World& world, const State& state, int w, Workspace& work) {
  if (world.velocities_per_world == 0 && !world.detects) return;
  work.velocities.resize(world.objects);
  for (int i = 0; i < world.objects; ++i) {
    work.velocities[i] = velocity_world(world, state, w * world.objects + i, work.extra);
  }
}

void sense(const World& world, State& state, int w, Workspace& work) {
  update_object_velocities(world, state, w, work);
  for (const Scan& sensor : world.scans) {
    const int row = w * world.objects + sensor.mount.object;
    scan(world, state, w, sensor, state.pose[row], state.heading(row), work, state.count[w] > 0);
  }
  for (const Scan& gauge : world.gauges) {
    const int row = w * world.objects + gauge.mount.object;
    scan(world, state, w, gauge, state.pose[row], state.heading(row), work, false);
  }
  if (world.fog && state.count[w] > 0) lift_fog(world, state, w, work);
}

}  // namespace irsim
