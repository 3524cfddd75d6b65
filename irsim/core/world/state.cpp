#include "world/state.hpp"

#include <algorithm>

#include "parallel.hpp"
#include "phases.hpp"
#include "world/features.hpp"
#include "world/spec.hpp"

namespace irsim {
namespace {

Goal goal_of(const std::vector<double>& numbers) {
  return {numbers[0], numbers[1], numbers.size() > 2 ? numbers[2] : kNone};
}

/// Whether an object runs a behavior with these options.
template <class Options>
bool runs(const World& world) {
  return std::any_of(world.behaviors.begin(), world.behaviors.end(),
                     [](const BehaviorGroup& group) { return std::holds_alternative<Options>(group.behavior); });
}

void evaluate(const World& world, State& state, int w, Workspace& work, bool with_arrival) {
  collide(world, state, w);
  if (with_arrival) arrive(world, state, w);
  sense(world, state, w, work);
}

/// Whether two poses are equal; poses of absent objects are.
bool same_pose(const Pose& a, const Pose& b) {
  const auto same = [](double p, double q) { return p == q || (std::isnan(p) && std::isnan(q)); };
  return same(a.x, b.x) && same(a.y, b.y) && same(a.theta, b.theta);
}

void set_initial_values(const World& world, State& state, int w) {
  for (int i = 0; i < world.objects; ++i) {
    const ObjectSpec& spec = world.specs[i];
    const int row = w * world.objects + i;
    const auto at = [](const std::vector<double>& v, std::size_t k) { return k < v.size() ? v[k] : 0.0; };
    state.pace[row] = state.speed_scale[row];
    state.start_step[row] = spec.start_step;
    state.initial_pose[row] = {at(spec.pose, 0), at(spec.pose, 1), at(spec.pose, 2)};
    state.initial_control[row] = {{at(spec.control, 0), at(spec.control, 1), at(spec.control, 2)}};
    for (int e = 0; e < state.extra_rows; ++e) {
      state.initial_extra[static_cast<std::size_t>(row) * state.extra_rows + e] = at(spec.extra, e);
    }
    state.goals[row].initial.clear();
    for (const auto& goal : spec.goals) {
      if (goal.size() >= 2) state.goals[row].initial.push_back(goal_of(goal));
    }
  }
}

constexpr int kMaxWanderDraws = 1000;  // goals drawn until one lies in no unknown cell of a map

/// Whether a body may meet unknown cells of a map at a place.
bool may_meet_unknown(const World& world, const Shapes& shapes, int object, Vec2 place) {
  return std::any_of(world.fixed_objects.begin(), world.fixed_objects.end(), [&](int i) {
    return shapes.is_map(i) &&
           shapes.parts[shapes.body[i].part].cells->any_unknown(box_around(place, shapes.radius[object]));
  });
}

}  // namespace

State::State(const World& world, const std::uint64_t* seeds, bool history_, bool drawn)
    : worlds(world.copies),
      objects(world.objects),
      rows(world.copies * world.objects),
      extra_rows(world.extra_rows),
      keep_history(history_),
      pose(rows),
      extra(static_cast<std::size_t>(rows) * extra_rows),
      control(rows),
      twist(rows),
      command(rows),
      commanded(rows),
      drive(rows),
      actuated(world.actuators.empty() ? 0 : rows),
      underfoot(world.wheels_slip ? rows : 0),
      contact_time(rows),
      air_time(rows),
      given(rows),
      arrived(rows),
      collided(rows),
      stopped(rows),
      believes_arrived(rows),
      touching(rows),
      radius(rows),
      vel_min(rows),
      vel_max(rows),
      acce(rows),
      pace(rows, 1.0),
      start_step(rows),
      appeared(rows),
      takes_part(rows, 1),
      size_scale(rows, 1.0),
      speed_scale(rows, 1.0),
      acceleration_scale(rows, 1.0),
      noise_scale(rows, 1.0),
      delay_scale(rows, 1.0),
      lag_scale(rows, 1.0),
      sensor_rate_scale(rows, 1.0),
      sensor_latency_scale(rows, 1.0),
      slip_scale(rows, 1.0),
      grip_scale(rows, 1.0),
      latency(rows),
      infeasible(rows),
      between_steps(rows),
      goal(rows, {kNone, kNone, kNone}),
      ranges(static_cast<std::size_t>(worlds) * world.beams_per_world),
      beam_angles(static_cast<std::size_t>(worlds) * world.beams_per_world),
      hits(static_cast<std::size_t>(worlds) * world.beams_per_world, -1),
      valid(static_cast<std::size_t>(worlds) * world.beams_per_world),
      velocities(static_cast<std::size_t>(worlds) * world.velocities_per_world),
      readings(static_cast<std::size_t>(worlds) * world.readings_per_world),
      stamp(worlds * world.sensors_per_world, kNone),
      explored(world.fog ? static_cast<std::size_t>(worlds) * world.fog->cells() : 0),
      count(worlds),
      scene_index(worlds),
      noise(worlds),
      level(worlds),
      variant(worlds, -1),
      seed(worlds),
      failed_placement(worlds, -1),
      pending{Array<double>(worlds * world.pending_times),       Array<double>(worlds * world.pending_beams),
              Array<double>(worlds * world.pending_velocities),  Array<double>(worlds * world.pending_readings),
              Array<std::int32_t>(worlds * world.pending_beams), Array<std::uint8_t>(worlds * world.pending_beams)},
      queue(worlds * world.queue_slots),
      direction(rows),
      direction_of(rows, kNone),
      goals(rows),
      goal_draws(rows),
      memory(static_cast<std::size_t>(worlds) * world.memory_per_world),
      before(rows),
      overshot(rows),
      initial_pose(rows),
      initial_extra(static_cast<std::size_t>(rows) * extra_rows),
      initial_control(rows),
      history(keep_history ? rows : 0),
      standings(keep_history ? rows : 0),
      scenes(worlds),
      fresh(worlds),
      event_count(worlds) {
  workspaces.emplace_back();
  if (!world.routed.empty()) routes.resize(rows), target.resize(rows);
  if (runs<AvocadoOptions>(world)) opinions.resize(rows);
  if (runs<FootprintOrcaOptions>(world)) detours.resize(rows);
  if (runs<RvoOptions>(world)) tied.assign(rows, -1);
  std::copy(seeds, seeds + worlds, seed.data);
  for (int w = 0; w < worlds; ++w) {
    for (const Scan& scan : world.scans) {
      std::copy(scan.mount.angle.begin(), scan.mount.angle.end(),
                beam_angles.data + static_cast<std::size_t>(w) * world.beams_per_world + scan.mount.first);
    }
    if (!drawn) show_nothing(world, *this, w);
    if (drawn) draw_scene(world, *this, w, workspaces.front());
  }
}

void place_fixed(const World& world, State& state, int w) {
  Scene& scene = state.scenes[w];
  std::vector<Pose> poses;
  poses.reserve(world.fixed_objects.size());
  for (const int i : world.fixed_objects) poses.push_back(state.pose[w * world.objects + i]);
  const auto is_current = [&](const std::shared_ptr<const Fixed>& fixed) {
    return fixed && std::equal(poses.begin(), poses.end(), fixed->poses.begin(), fixed->poses.end(), same_pose);
  };
  if (is_current(scene.fixed)) return;
  const World& from = variant_of(world, state, w);
  if (scene.shapes == from.shapes && is_current(from.fixed)) {
    scene.fixed = from.fixed;
  } else {
    scene.fixed = make_fixed(world, *scene.shapes, std::move(poses));
  }
}

void set_limits(const World& world, State& state, int row) {
  const int object = row % world.objects;
  state.vel_min[row] = world.vel_min[object];
  state.vel_max[row] = world.vel_max[object];
  state.acce[row] = world.acce[object];
  for (int c = 0; c < 3; ++c) {
    state.acce[row][c] *= state.acceleration_scale[row];
    if (!world.paced[object][c]) continue;
    state.vel_min[row][c] *= state.pace[row];
    state.vel_max[row][c] *= state.pace[row];
  }
}

void restart_row(const World& world, State& state, int row) {
  const int w = row / world.objects, i = row % world.objects;
  const std::size_t e = static_cast<std::size_t>(row) * state.extra_rows;
  state.pose[row] = state.initial_pose[row];
  state.appeared[row] = 0;
  if (!state.takes_part[row] || state.count[w] < world.specs[i].appear_step) leave_world(state, row);
  std::copy_n(&state.initial_extra[e], state.extra_rows, &state.extra[e]);
  state.before[row] = state.pose[row];
  state.control[row] = state.start_step[row] > 0 ? Vec3{} : state.initial_control[row];
  state.twist[row] = state.command[row] = {};
  state.commanded[row] = {};
  state.drive[row] = world.dynamics[i].driven ? state.control[row] : Vec3{};
  if (world.has_actuators[i]) rest_at(world, state, row, state.control[row]);
  if (world.wheels_slip) state.underfoot[row] = {};
  state.contact_time[row] = state.air_time[row] = 0.0;
  state.touching[row] = 0;
  state.given[row] = state.arrived[row] = state.collided[row] = state.stopped[row] = 0;
  state.believes_arrived[row] = 0;
  state.radius[row] = state.scenes[w].shapes->radius[i];
  state.infeasible[row] = state.between_steps[row] = 0;
  state.goal_draws[row] = 0;
  if (!state.routes.empty()) state.routes[row] = {};
  if (!state.opinions.empty()) state.opinions[row] = {};
  if (!state.detours.empty()) state.detours[row] = {};
  if (!state.tied.empty()) state.tied[row] = -1;
  if (state.keep_history) state.history[row].clear(), state.standings[row].clear();
  if (world.wander[i]) {
    draw_wander_goal(world, state, w, i);
    state.goals[row].initial = state.goals[row].goals;
  } else {
    state.goals[row].set(state.goals[row].initial);
    state.sync_goal(row);
  }
}

void restart(const World& world, State& state, int w, Workspace& work) {
  Scene& scene = state.scenes[w];
  state.count[w] = 0;
  scene.events.clear();
  scene.pairs.clear();
  scene.in_motion = false;
  scene.held.clear();
  if (world.fog) std::fill_n(state.explored.data + w * world.fog->cells(), world.fog->cells(), std::uint8_t{0});
  scene.contacts.clear();
  for (int i = 0; i < world.objects; ++i) restart_row(world, state, w * world.objects + i);
  place_fixed(world, state, w);
  show_nothing(world, state, w);
  evaluate(world, state, w, work, true);
  scene.watched = {};
  watch(world, state, w, work);
}

void draw_scene(const World& world, State& state, int w, Workspace& work) {
  Scene& scene = state.scenes[w];
  vary(world, state, w);
  const World& from = variant_of(world, state, w);
  set_initial_values(from, state, w);
  scene.shapes = from.shapes ? from.shapes : make_shapes(from, make_key(state.seed[w], state.scene_index[w], 0));
  const double* scales = state.size_scale.data + w * world.objects;
  if (std::any_of(scales, scales + world.objects, [](double scale) { return scale != 1.0; }))
    scene.shapes = scene.shapes->scaled(scales);
  scene.moving.resize(scene.shapes->size[0]);
  scene.sweep.reset(world.moving);
  scene.fixed = nullptr;
  scene.bodies = nullptr;
  state.failed_placement[w] = -1;
  if (!from.placements.empty()) place_randomly(from, state, w);
  if (!from.perturbations.empty() && state.failed_placement[w] < 0) perturb(from, state, w);
  for (int i = 0; i < world.objects; ++i) set_limits(world, state, w * world.objects + i);
  restart(world, state, w, work);
}

void reset(const World& world, State& state, const std::uint8_t* mask, bool next_scene, int threads) {
  std::vector<int> chosen;
  for (int w = 0; w < state.worlds; ++w) {
    if (mask[w]) chosen.push_back(w);
  }
  threads = std::max(1, std::min(threads, static_cast<int>(chosen.size())));
  while (static_cast<int>(state.workspaces.size()) < threads) state.workspaces.emplace_back();
  one_by_one(state.crew, chosen.size(), threads, [&](std::size_t k, int thread) {
    const int w = chosen[k];
    Workspace& work = state.workspaces[thread];
    if (state.fresh[w] || next_scene) {
      state.scene_index[w] = state.fresh[w] ? 0 : state.scene_index[w] + 1;
      state.noise[w] = 0;
      state.fresh[w] = 0;
      draw_scene(world, state, w, work);
    } else {
      ++state.noise[w];
      restart(world, state, w, work);
    }
  });
}

void reseed(State& state, const std::uint64_t* seeds, const std::uint8_t* mask) {
  for (int w = 0; w < state.worlds; ++w) {
    if (!mask[w]) continue;
    state.seed[w] = seeds[w];
    state.fresh[w] = 1;
  }
}

void refresh(const World& world, State& state) {
  for (int w = 0; w < state.worlds; ++w) {
    place_fixed(world, state, w);
    evaluate(world, state, w, state.workspaces.front(), false);
  }
}

void draw_wander_goal(const World& world, State& state, int w, int object) {
  const int row = w * world.objects + object;
  const Draws draws(state.key(w), Stream::goal, world.number[object]);
  const World& from = variant_of(world, state, w);
  const Pose &low = from.range_low[object], &high = from.range_high[object];
  Goal goal;
  for (int attempt = 0; attempt < kMaxWanderDraws; ++attempt) {
    const std::uint64_t first = 3 * static_cast<std::uint64_t>(state.goal_draws[row]++);
    goal = {draws.uniform(first, low.x, high.x), draws.uniform(first + 1, low.y, high.y),
            draws.uniform(first + 2, low.theta, high.theta)};
    if (!may_meet_unknown(from, *state.scenes[w].shapes, object, goal.position())) break;
  }
  state.goals[row].set({goal});
  state.sync_goal(row);
}

const Bodies& bodies_of(const World& world, State& state, int w) {
  Scene& scene = state.scenes[w];
  if (!scene.bodies) {
    const World& from = variant_of(world, state, w);
    scene.bodies = from.bodies && scene.shapes == from.shapes ? from.bodies : make_bodies(from, *scene.shapes);
  }
  return *scene.bodies;
}

void pose_changed(const World& world, State& state, int row) {
  if (world.is_static[row % world.objects]) place_fixed(world, state, row / world.objects);
}

Vec2 velocity_world(const World& world, const State& state, int row) {
  std::vector<double> scratch;
  return velocity_world(world, state, row, scratch);
}

Vec2 velocity_world(const World& world, const State& state, int row, std::vector<double>& scratch) {
  return velocity_of_control(world, state, row, state.control[row], scratch);
}

Vec2 velocity_of_control(const World& world, const State& state, int row, Vec3 control, std::vector<double>& scratch) {
  const int object = row % world.objects;
  if (!world.dynamics[object].driven) return {control[0], control[1]};
  Vec3 twist = state.twist[row];
  with(world.drive[object], [&](const auto& drive) {
    Pose pose = state.pose[row];
    const double* extra = &state.extra[static_cast<std::size_t>(row) * state.extra_rows];
    scratch.assign(extra, extra + state.extra_rows);
    run(drive, Motion{pose, scratch.data(), twist, state.heading(row), control, 0.0, world.integration,
                      state.footing(world, row)});
  });
  return {twist[0], twist[1]};
}

}  // namespace irsim
