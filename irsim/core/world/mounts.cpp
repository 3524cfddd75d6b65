#include "world/mounts.hpp"

#include <algorithm>
#include <stdexcept>

#include "sensing/beams.hpp"
#include "world/features.hpp"
#include "world/spec.hpp"
#include "world/world.hpp"

namespace irsim {
namespace {

constexpr double kMaxFogBeams = 20000.0;  // largest number of beams of one view of the fog

Mount mount_of(int object, int index) { return {object, index, 0, 0, 0, 0, 0, 0, 0, 0, {}, {}, {}, {}}; }

/// Set the nominal beams of a mount; the beams of `like` are copied if the angles are equal.
void set_beams(Mount& mount, std::vector<double> angles, const Mount* like = nullptr) {
  mount.count = static_cast<int>(angles.size());
  if (like != nullptr && like->angle == angles) {
    mount.angle = std::move(angles), mount.cosine = like->cosine, mount.sine = like->sine;
    return;
  }
  mount.angle = std::move(angles);
  for (const double angle : mount.angle) {
    mount.cosine.push_back(std::cos(angle));
    mount.sine.push_back(std::sin(angle));
  }
}

/// Parts of a mount with about equally many beams.
std::vector<Mount> split(const Mount& mount, int parts) {
  std::vector<Mount> out;
  for (int k = 0; k < parts; ++k) {
    const auto begin = static_cast<std::ptrdiff_t>(mount.count) * k / parts;
    const auto end = static_cast<std::ptrdiff_t>(mount.count) * (k + 1) / parts;
    const auto cut = [&](const std::vector<double>& list) {
      return std::vector<double>(list.begin() + begin, list.begin() + end);
    };
    Mount part = mount;
    part.first += static_cast<int>(begin), part.count = static_cast<int>(end - begin);
    part.angle = cut(mount.angle), part.cosine = cut(mount.cosine), part.sine = cut(mount.sine);
    out.push_back(std::move(part));
  }
  return out;
}

/// Give the measurements of a sensor that are on their way their places.
void lay_out(World& world, const Mount& mount, Timetable& made) {
  const auto slots = static_cast<std::size_t>(made.slots), beams = static_cast<std::size_t>(mount.reported());
  made.first_time = world.pending_times, made.first_beam = world.pending_beams;
  made.first_velocity = world.pending_velocities, made.first_reading = world.pending_readings;
  world.pending_times += slots, world.pending_beams += slots * beams;
  world.pending_velocities += slots * beams * static_cast<std::size_t>(mount.velocity_rows);
  world.pending_readings += slots * static_cast<std::size_t>(mount.readings);
}

/// The times of a sensor, with places for its measurements on their way.
Timetable times_of(World& world, const ObjectSpec& spec, std::size_t k, const Mount& mount) {
  if (spec.timing.empty()) return {};
  Timetable made = timetable_of(spec.timing[k], world.step_time);
  lay_out(world, mount, made);
  return made;
}

/// The largest factor that a scene may draw for a quantity of an object; 0 if it is never drawn.
double largest_factor(const World& world, int object, Quantity quantity) {
  double largest = 0.0;
  for (const Level& level : world.levels) {
    for (const Variation& v : level.variations) {
      const bool named = std::find(v.objects.begin(), v.objects.end(), object) != v.objects.end();
      if (v.quantity == quantity && named) largest = std::max({largest, v.high, 1.0});
    }
  }
  return largest;
}

}  // namespace

void add_fog_beams(World& world) {
  const Fog& fog = *world.fog;
  if (fog.columns < 1 || fog.rows < 1) throw std::invalid_argument("fog needs at least one cell");
  if (std::max(fog.columns, fog.rows) > kMaxFogCells) throw std::invalid_argument("fog has too many cells");
  const double cell = std::min(fog.cell().x, fog.cell().y);
  for (const View& view : fog.views) {
    if (view.object < 0 || view.object >= world.objects)
      throw std::invalid_argument("a view of the fog names an object that does not exist");
    Mount mount = mount_of(view.object, 0);
    if (view.occlusion) {
      const double wanted = std::ceil(2.0 * view.angle * view.reach / cell);
      set_beams(mount, spread_beams(view.angle, 1 + static_cast<int>(clip(wanted, 1.0, kMaxFogBeams)), true));
    }
    world.fog_beams.push_back(std::move(mount));
  }
}

void add_scans(World& world, int object, const ObjectSpec& spec) {
  for (std::size_t k = 0; k < spec.sensors.size(); ++k) {
    if (std::holds_alternative<std::monostate>(spec.sensors[k])) continue;  // this sensor is computed in Python
    Mount mount = mount_of(object, static_cast<int>(k));
    mount.first = world.beams_per_world, mount.first_velocity = world.velocities_per_world;
    mount.first_reading = world.readings_per_world, mount.first_memory = world.memory_per_world;
    with(spec.sensors[k], [&](const auto& options) {
      set_beams(mount, beams(options), world.scans.empty() ? nullptr : &world.scans.back().mount);
      mount.velocity_rows = velocity_rows(options), mount.offset = mounted_at(options);
      mount.readings = readings(options), mount.memory = memory(options);
    });
    ++world.sensors_per_world;
    world.readings_per_world += mount.readings, world.memory_per_world += mount.memory;
    if (mount.readings > 0) {  // its rays are not reported, so they have no place among the beams of the world
      world.gauges.push_back({spec.sensors[k], mount, {}, times_of(world, spec, k, mount), kInfinity});
      world.detects = world.detects || std::holds_alternative<DetectorOptions>(spec.sensors[k]);
      continue;
    }
    world.beams_per_world += mount.count;
    world.velocities_per_world += mount.count * mount.velocity_rows;
    int parts = 1;
    double reach = kInfinity;
    with(spec.sensors[k],
         [&](const auto& options) { parts = std::min(sweep_parts(options), mount.count), reach = farthest(options); });
    world.scans.push_back({spec.sensors[k], mount, parts > 1 ? split(mount, parts) : std::vector<Mount>(),
                           times_of(world, spec, k, mount), reach});
  }
}

void lay_out_pending(World& world) {
  world.pending_times = world.pending_beams = world.pending_velocities = world.pending_readings = 0;
  for (std::vector<Scan>* sensors : {&world.scans, &world.gauges}) {
    for (Scan& sensor : *sensors) {
      const double on_rate = largest_factor(world, sensor.mount.object, Quantity::sensor_rate);
      const double on_latency = largest_factor(world, sensor.mount.object, Quantity::sensor_latency);
      Timetable& times = sensor.times;
      times.varies = (on_rate > 0.0 && times.rate > 0.0) || (on_latency > 0.0 && times.latency > 0.0);
      times.slots = slots_of(scaled(times, std::max(1.0, on_rate), std::max(1.0, on_latency)));
      lay_out(world, sensor.mount, times);
    }
  }
}

}  // namespace irsim
