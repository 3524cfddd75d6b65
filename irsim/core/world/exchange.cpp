#include "world/exchange.hpp"

#include <algorithm>

#include "phases.hpp"
#include "sensing.hpp"
#include "world/features.hpp"
#include "world/spec.hpp"

namespace irsim {
namespace {

/// Copy a row between states, which may differ in the number of extra rows.
void copy_row(State& to, int row, const State& from, int old_row) {
  to.pose[row] = from.pose[old_row];
  to.control[row] = from.control[old_row];
  to.twist[row] = from.twist[old_row];
  to.command[row] = from.command[old_row];
  to.commanded[row] = from.commanded[old_row];
  to.drive[row] = from.drive[old_row];
  to.contact_time[row] = from.contact_time[old_row];
  to.air_time[row] = from.air_time[old_row];
  to.touching[row] = from.touching[old_row];
  to.given[row] = from.given[old_row];
  to.arrived[row] = from.arrived[old_row];
  to.collided[row] = from.collided[old_row];
  to.stopped[row] = from.stopped[old_row];
  to.goals[row] = from.goals[old_row];
  to.infeasible[row] = from.infeasible[old_row];
  to.between_steps[row] = from.between_steps[old_row];
  to.pace[row] = from.pace[old_row];
  to.takes_part[row] = from.takes_part[old_row];
  to.size_scale[row] = from.size_scale[old_row];
  to.speed_scale[row] = from.speed_scale[old_row];
  to.acceleration_scale[row] = from.acceleration_scale[old_row];
  to.noise_scale[row] = from.noise_scale[old_row];
  to.delay_scale[row] = from.delay_scale[old_row];
  to.lag_scale[row] = from.lag_scale[old_row];
  to.sensor_rate_scale[row] = from.sensor_rate_scale[old_row];
  to.sensor_latency_scale[row] = from.sensor_latency_scale[old_row];
  to.slip_scale[row] = from.slip_scale[old_row];
  to.grip_scale[row] = from.grip_scale[old_row];
  to.latency[row] = from.latency[old_row];
  to.start_step[row] = from.start_step[old_row];
  to.appeared[row] = from.appeared[old_row];
  to.before[row] = from.before[old_row];
  to.goal_draws[row] = from.goal_draws[old_row];
  to.initial_pose[row] = from.initial_pose[old_row];
  to.initial_control[row] = from.initial_control[old_row];
  const int both = std::min(to.extra_rows, from.extra_rows);
  const std::size_t e = static_cast<std::size_t>(row) * to.extra_rows;
  const std::size_t old_e = static_cast<std::size_t>(old_row) * from.extra_rows;
  std::copy_n(&from.extra[old_e], both, &to.extra[e]);
  std::copy_n(&from.initial_extra[old_e], both, &to.initial_extra[e]);
  if (to.underfoot.size > 0) to.underfoot[row] = from.underfoot.size > 0 ? from.underfoot[old_row] : Underfoot{};
  to.sync_goal(row);
  to.overshot[row] = from.overshot[old_row];
  to.believes_arrived[row] = from.believes_arrived[old_row];
}

/// Copy what the actuators of a row keep, and the commands that wait in their queue.
void copy_actuators(const World& world, State& to, int row, const Origin& origin) {
  if (!world.has_actuators[row]) return;
  const World& world_before = *origin.world;
  const bool alike = world_before.has_actuators[origin.object] &&
                     same(*world.specs[row].actuation, *world_before.specs[origin.object].actuation);
  if (!alike || origin.state->count[0] != to.count[0]) return rest_at(world, to, row, to.control[row]);
  const Actuators &now = world.actuators[row], &before = world_before.actuators[origin.object];
  to.actuated[row] = origin.state->actuated[origin.object];
  std::copy_n(origin.state->queue.data() + before.first, now.slots, to.queue.data() + now.first);
}

/// Copy what the sensors of a row remember, and their readings, where they are the same sensors at the same time.
void copy_readings(const World& world, State& to, int row, const Origin& origin) {
  if (origin.state->count[0] != to.count[0]) return;
  go_on_showing(world, to, row, *origin.world, *origin.state, origin.object);
  for (const Scan& now : world.gauges) {
    const Mount& mount = now.mount;
    if (mount.object != row) continue;
    for (const Scan& before : origin.world->gauges) {
      const Mount& old = before.mount;
      if (old.object != origin.object || old.index != mount.index || old.memory != mount.memory) continue;
      std::copy_n(origin.state->memory.data() + old.first_memory, old.memory, to.memory.data() + mount.first_memory);
      if (now.times.each_step() && before.times.each_step())
        std::copy_n(origin.state->readings.data + old.first_reading, old.readings,
                    to.readings.data + mount.first_reading);
    }
  }
}

/// The recorded history of a row, with the given number of extra rows.
std::vector<double> track_of(const State& from, int row, int extra_rows) {
  if (!from.keep_history) return {};
  const std::vector<double>& old = from.history[row];
  if (from.extra_rows == extra_rows) return old;
  const std::size_t columns = 3 + static_cast<std::size_t>(from.extra_rows);
  const int both = 3 + std::min(from.extra_rows, extra_rows);
  std::vector<double> track;
  for (std::size_t k = 0; k < old.size(); k += columns) {
    for (int c = 0; c < 3 + extra_rows; ++c) track.push_back(c < both ? old[k + c] : 0.0);
  }
  return track;
}

/// The watched zones and views, with the indices of the new objects. Objects that have gone leave their zones and all
/// views.
Watched continue_watching(const World& world, State& state, const World& world_before, const State& before,
                          const std::vector<int>& new_row) {
  const Watched& old = before.scenes[0].watched;
  const std::size_t n = world.objects, old_n = world_before.objects;
  const int zones = std::min(world.zones.count(), world_before.zones.count());
  Watched out;
  if (zones == 0 && world.views.empty() && world_before.views.empty()) return out;
  out.inside.assign(world.zones.count() * n, 0);
  out.seen.assign(world.views.size() * n, 0);
  for (std::size_t i = 0; i < n; ++i) out.position.push_back(state.pose[static_cast<int>(i)].position());
  for (std::size_t i = 0; i < old.position.size(); ++i) {
    if (new_row[i] >= 0) out.position[new_row[i]] = old.position[i];
  }
  for (int zone = 0; zone < zones; ++zone) {
    for (std::size_t i = 0; i < old_n; ++i) {
      if (!old.inside[zone * old_n + i]) continue;
      if (new_row[i] >= 0) {
        out.inside[zone * n + new_row[i]] = 1;
      } else {
        state.log_numbers(0, EventKind::zone_exit, world_before.number[i], zone, old.position[i]);
      }
    }
  }
  for (std::size_t v = 0; v < world_before.views.size(); ++v) {
    const int object = world_before.views[v].object;
    const auto now = std::find_if(world.views.begin(), world.views.end(),
                                  [&](const View& view) { return view.object == new_row[object]; });
    for (std::size_t i = 0; i < old_n; ++i) {
      if (!old.seen[v * old_n + i]) continue;
      if (now != world.views.end() && new_row[i] >= 0 && world.is_target[new_row[i]]) {
        out.seen[(now - world.views.begin()) * n + new_row[i]] = 1;
      } else {
        state.log_numbers(0, EventKind::sight_end, world_before.number[object], world_before.number[i],
                          old.position[i]);
      }
    }
  }
  return out;
}

/// Pairs of old rows as pairs of new rows; pairs of removed objects are left out.
std::vector<Pair> rename_pairs(const std::vector<Pair>& pairs, const std::vector<int>& new_row) {
  std::vector<Pair> out;
  for (const auto& [i, j] : pairs) {
    const int a = new_row[i], b = new_row[j];
    if (a >= 0 && b >= 0) out.emplace_back(std::min(a, b), std::max(a, b));
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// Pairs that stopped where they touched, with the indices of the new objects.
std::vector<HeldPair> rename_held(const std::vector<HeldPair>& pairs, const std::vector<int>& new_row) {
  std::vector<HeldPair> out;
  for (const HeldPair& pair : pairs) {
    const int a = new_row[pair.a], b = new_row[pair.b];
    if (a < 0 || b < 0) continue;
    out.push_back(a < b ? HeldPair{a, b, pair.pose_a, pair.pose_b} : HeldPair{b, a, pair.pose_b, pair.pose_a});
  }
  return out;
}

/// Rebuild the geometry of all objects after `scene.shapes` has changed.
void rebuild_geometry(const World& world, State& state, int w) {
  Scene& scene = state.scenes[w];
  for (int i = 0; i < world.objects; ++i) state.radius[w * world.objects + i] = scene.shapes->radius[i];
  scene.moving.resize(scene.shapes->size[0]);
  scene.fixed = nullptr;
  scene.bodies = nullptr;
  place_fixed(world, state, w);
  place_moving(world, state, w);
}

}  // namespace

void continue_from(const World& world, State& state, const World& world_before, const State& before,
                   const std::vector<Origin>& origins) {
  state.count[0] = before.count[0];
  state.scene_index[0] = before.scene_index[0];
  state.noise[0] = before.noise[0];
  state.level[0] = before.level[0];
  state.variant[0] = before.variant[0];
  state.seed[0] = before.seed[0];
  state.fresh[0] = before.fresh[0];
  state.event_count[0] = before.event_count[0];
  Scene& scene = state.scenes[0] = before.scenes[0];
  if (state.explored.size == before.explored.size) {
    std::copy_n(before.explored.data, before.explored.size, state.explored.data);
  }
  auto shapes = std::make_shared<Shapes>();
  std::vector<int> new_row(world_before.objects, -1);
  for (int i = 0; i < world.objects; ++i) {
    const Origin& origin = origins[i];
    if (origin.state == &before) new_row[origin.object] = i;
    copy_row(state, i, *origin.state, origin.object);
    copy_actuators(world, state, i, origin);
    copy_readings(world, state, i, origin);
    if (origin.state == &before && !before.opinions.empty() && !state.opinions.empty()) {
      state.opinions[i] = before.opinions[origin.object];
    }
    if (origin.state == &before && !before.detours.empty() && !state.detours.empty()) {
      state.detours[i] = before.detours[origin.object];
    }
    if (origin.state == &before && !before.tied.empty() && !state.tied.empty()) {
      state.tied[i] = before.tied[origin.object];
    }
    set_limits(world, state, i);
    if (state.keep_history) {
      state.history[i] = track_of(*origin.state, origin.object, state.extra_rows);
      state.standings[i] = origin.state == &before ? before.standings[origin.object] : std::vector<Standing>();
    }
    shapes->copy(*origin.state->scenes[0].shapes, origin.object, world.is_static[i] != 0);
  }
  scene.shapes = std::move(shapes);
  scene.sweep.reset(world.moving);
  scene.contacts.clear();
  scene.pairs = rename_pairs(before.scenes[0].pairs, new_row);
  scene.held = rename_held(before.scenes[0].held, new_row);
  scene.meetings.clear();
  scene.watched = continue_watching(world, state, world_before, before, new_row);
  rebuild_geometry(world, state, 0);
  sense(world, state, 0, state.workspaces.front());
}

void reshape(const World& world, State& state, int row, const std::vector<Outline>& outlines) {
  const int w = row / world.objects;
  Scene& scene = state.scenes[w];
  auto shapes = std::make_shared<Shapes>();
  for (int i = 0; i < world.objects; ++i) {
    const bool fixed = world.is_static[i] != 0;
    if (i == row % world.objects) {
      shapes->add(outlines, fixed);
    } else {
      shapes->copy(*scene.shapes, i, fixed);
    }
  }
  scene.shapes = std::move(shapes);
  rebuild_geometry(world, state, w);
}

}  // namespace irsim
