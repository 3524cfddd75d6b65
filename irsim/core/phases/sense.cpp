// Every sensor takes its scan, and robots clear the fog where they see.
#include <algorithm>

#include "phases.hpp"
#include "sensing.hpp"
#include "sensing/fog.hpp"
#include "world/features.hpp"

namespace irsim {
namespace {

/// Where the data of a sensor are written.
struct Data {
  double* ranges;
  std::int32_t* hits;
  std::uint8_t* valid;
  double *velocities, *readings, *stamp;
};

/// The data that the sensors of a world show.
Data shown(const World& world, const State& state, int w) {
  const auto at = static_cast<std::size_t>(w);
  const std::size_t beam = at * world.beams_per_world;
  return {state.ranges.data + beam,
          state.hits.data + beam,
          state.valid.data + beam,
          state.velocities.data + at * world.velocities_per_world,
          state.readings.data + at * world.readings_per_world,
          state.stamp.data + at * world.sensors_per_world};
}

/// The data of one of them; `number` is its place among them.
Data part_of(const Data& all, const Mount& mount, std::size_t number) {
  return {all.ranges + mount.first,
          all.hits + mount.first,
          all.valid + mount.first,
          all.velocities + mount.first_velocity,
          all.readings + mount.first_reading,
          all.stamp + number};
}

/// The times of a sensor in the present scene of a world.
Timetable times_in(const World& world, const State& state, int w, const Scan& sensor) {
  if (!sensor.times.varies) return sensor.times;
  const int row = w * world.objects + sensor.mount.object;
  return scaled(sensor.times, state.sensor_rate_scale[row], state.sensor_latency_scale[row]);
}

/// A slot of a sensor whose data are late.
Data in_slot(const World& world, const State& state, int w, const Scan& sensor, std::size_t slot) {
  const Timetable& times = sensor.times;
  const Mount& mount = sensor.mount;
  const Pending& pending = state.pending;
  const auto at = static_cast<std::size_t>(w);
  const auto beams = static_cast<std::size_t>(mount.reported());
  const std::size_t beam = at * world.pending_beams + times.first_beam + slot * beams;
  const std::size_t numbers = beams * static_cast<std::size_t>(mount.velocity_rows);
  const auto readings = static_cast<std::size_t>(mount.readings);
  return {pending.ranges.data + beam,
          pending.hits.data + beam,
          pending.valid.data + beam,
          pending.velocities.data + at * world.pending_velocities + times.first_velocity + slot * numbers,
          pending.readings.data + at * world.pending_readings + times.first_reading + slot * readings,
          pending.time.data + at * world.pending_times + times.first_time + slot};
}

/// The slot of the last measurement until a step.
Data on_the_way(const World& world, const State& state, int w, const Scan& sensor, const Timetable& times,
                std::int64_t step) {
  return in_slot(world, state, w, sensor, times.slot(step));
}

void copy(const Mount& mount, const Data& from, const Data& to) {
  std::copy_n(from.ranges, mount.reported(), to.ranges);
  std::copy_n(from.hits, mount.reported(), to.hits);
  std::copy_n(from.valid, mount.reported(), to.valid);
  std::copy_n(from.velocities, mount.reported() * mount.velocity_rows, to.velocities);
  std::copy_n(from.readings, mount.readings, to.readings);
  *to.stamp = *from.stamp;
}

/// Whether two sensors measure the same numbers at the same times.
bool alike(const Scan& a, const Scan& b) {
  const Mount &p = a.mount, &q = b.mount;
  return a.sensor.index() == b.sensor.index() && a.times == b.times && p.index == q.index && p.count == q.count &&
         p.velocity_rows == q.velocity_rows && p.readings == q.readings;
}

void measure(const World& world, State& state, int w, const Scan& sensor, const Pose& pose, Vec2 direction,
             Workspace& work, bool sweeping, const Data& to, std::int64_t steps) {
  static const std::vector<Mount> kAtOnce;
  const Mount& mount = sensor.mount;
  Sensing sensing{world,
                  state,
                  w,
                  mount,
                  pose,
                  direction,
                  to.ranges,
                  to.hits,
                  to.valid,
                  to.velocities,
                  to.readings,
                  state.memory.data() + static_cast<std::size_t>(w) * world.memory_per_world + mount.first_memory,
                  work.velocities.data(),
                  work.beams,
                  work.blockers,
                  sweeping ? sensor.parts : kAtOnce,
                  work.ghost,
                  0,
                  mount.count};
  sensing.steps = steps;
  with(sensor.sensor, [&](const auto& options) { run(options, sensing); });
  if (steps > 0) *to.stamp = static_cast<double>(state.count[w]) * world.step_time;
}

/// The step of a sensor that measures in some steps only, or whose data are late.
void measure_in_time(const World& world, State& state, int w, const Scan& sensor, const Pose& pose, Vec2 direction,
                     Workspace& work, bool sweeping, const Data& show) {
  const Timetable times = times_in(world, state, w, sensor);
  const std::int64_t step = state.count[w];
  if (times.due(step)) {
    const Data to = times.delay > 0 ? on_the_way(world, state, w, sensor, times, step) : show;
    measure(world, state, w, sensor, pose, direction, work, sweeping, to, times.steps_since(step));
  } else if (sensor.mount.memory > 0) {
    work.readings.resize(static_cast<std::size_t>(sensor.mount.readings));
    Data nowhere = show;
    nowhere.readings = work.readings.data();
    measure(world, state, w, sensor, pose, direction, work, sweeping, nowhere, 0);
  }
  if (times.delay > 0 && times.arrives(step)) {
    copy(sensor.mount, on_the_way(world, state, w, sensor, times, step - times.delay), show);
  }
}

void sense_all(const World& world, State& state, int w, Workspace& work, const std::vector<Scan>& sensors,
               std::size_t first, bool sweeping) {
  const Data all = shown(world, state, w);
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    const Scan& sensor = sensors[k];
    const int row = w * world.objects + sensor.mount.object;
    const Data show = part_of(all, sensor.mount, first + k);
    if (sensor.times.each_step()) {
      measure(world, state, w, sensor, state.pose[row], state.heading(row), work, sweeping, show, 1);
    } else {
      measure_in_time(world, state, w, sensor, state.pose[row], state.heading(row), work, sweeping, show);
    }
  }
}

}  // namespace

void scan(const World& world, State& state, int w, int number, const Pose& pose, Vec2 direction, Workspace& work) {
  const Scan& sensor = world.scans[number];
  measure(world, state, w, sensor, pose, direction, work, false, part_of(shown(world, state, w), sensor.mount, number),
          1);
}

void show_nothing(const World& world, State& state, int w) {
  for (const std::vector<Scan>* sensors : {&world.scans, &world.gauges}) {
    const std::size_t first = sensors == &world.scans ? 0 : world.scans.size();
    for (std::size_t k = 0; k < sensors->size(); ++k) {
      const Scan& sensor = (*sensors)[k];
      if (sensor.times.each_step()) continue;
      const Mount& mount = sensor.mount;
      const Data show = part_of(shown(world, state, w), mount, first + k);
      std::fill_n(show.ranges, mount.reported(), sensor.farthest);
      std::fill_n(show.hits, mount.reported(), -1);
      std::fill_n(show.valid, mount.reported(), std::uint8_t{0});
      std::fill_n(show.velocities, mount.reported() * mount.velocity_rows, 0.0);
      std::fill_n(show.readings, mount.readings, kNone);
      *show.stamp = kNone;
      for (std::int64_t slot = 0; slot < sensor.times.slots; ++slot) {
        copy(mount, show, in_slot(world, state, w, sensor, static_cast<std::size_t>(slot)));
      }
    }
  }
}

void go_on_showing(const World& world, State& state, int object, const World& world_before, const State& before,
                   int object_before) {
  for (const bool beams : {true, false}) {
    const std::vector<Scan>&now = beams ? world.scans : world.gauges,
          &then = beams ? world_before.scans : world_before.gauges;
    for (std::size_t k = 0; k < now.size(); ++k) {
      if (now[k].mount.object != object || now[k].times.each_step()) continue;
      for (std::size_t j = 0; j < then.size(); ++j) {
        if (then[j].mount.object != object_before || !alike(now[k], then[j])) continue;
        const Mount& mount = now[k].mount;
        copy(mount, part_of(shown(world_before, before, 0), then[j].mount, j + (beams ? 0 : world_before.scans.size())),
             part_of(shown(world, state, 0), mount, k + (beams ? 0 : world.scans.size())));
        for (std::int64_t slot = 0; slot < now[k].times.slots; ++slot) {
          const auto at = static_cast<std::size_t>(slot);
          copy(mount, in_slot(world_before, before, 0, then[j], at), in_slot(world, state, 0, now[k], at));
        }
      }
    }
  }
}

const double* just_measured(const World& world, const State& state, int w, const Scan& sensor) {
  const std::int64_t step = state.count[w];
  const Timetable times = times_in(world, state, w, sensor);
  if (!times.due(step)) return nullptr;
  return times.delay > 0 ? on_the_way(world, state, w, sensor, times, step).ranges
                         : part_of(shown(world, state, w), sensor.mount, 0).ranges;
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
  sense_all(world, state, w, work, world.scans, 0, state.count[w] > 0);
  sense_all(world, state, w, work, world.gauges, world.scans.size(), false);
  if (world.fog && state.count[w] > 0) lift_fog(world, state, w, work);
}

}  // namespace irsim
