// Goals of objects that have arrived are renewed, then behaviors choose commands.
#include <algorithm>

#include "braking/brake_in_time.hpp"
#include "phases.hpp"
#include "routes/route.hpp"
#include "surroundings/goal_heading.hpp"
#include "world/features.hpp"

namespace irsim {
namespace {

bool is_idle(const World& world, const State& state, int first, int object) {
  return world.is_static[object] || state.stopped[first + object] || state.waits(first + object);
}

/// Let the behavior of `group` decide for the objects listed in `work.objects`.
void run_behavior(const World& world, State& state, int w, const BehaviorGroup& group, Workspace& work) {
  const int first = w * world.objects, count = static_cast<int>(work.objects.size());
  if (work.intents.size() < work.objects.size()) work.intents.resize(work.objects.size());
  const Decision decision{world,
                          state,
                          first,
                          work.objects.data(),
                          count,
                          group.members,
                          group.grouped,
                          work,
                          state.opinions.data(),
                          state.detours.data(),
                          state.tied.data()};
  Intent* intents = work.intents.data();
  const bool brakes = brakes_in_time(world, group.objects.front());
  with(group.behavior, [&](const auto& options) { run(options, decision, intents); });
  for (int k = 0; k < count; ++k) {
    const int object = work.objects[k];
    const Intent& intent = intents[k];
    state.infeasible[first + object] += intent.infeasible;
    if (intent.kind == Intent::velocity_world) {
      command_velocity(world, state, w, object, intent.velocity, intent.turning);
    } else {
      state.command[first + object] = intent.control;
      if (world.state_arrival[object] && !intent.final)
        face_goal(world, state, first + object, object, state.command[first + object]);
    }
    if (brakes && has_inertia(state, first + object)) brake_in_time(decision, k, state.command[first + object]);
  }
}

/// Let the behavior of `group` decide for each of its objects that does not know the truth.
void run_believers(const World& world, State& state, int w, const BehaviorGroup& group, Workspace& work) {
  const int first = w * world.objects;
  for (const int i : group.objects) {
    if (!believes(world, i) || is_idle(world, state, first, i) || state.given[first + i]) continue;
    const Belief belief(world, state, w, i, work, work.replaced);
    work.objects.assign(1, i);
    run_behavior(world, state, w, group, work);
  }
}

}  // namespace

void renew_goals(const World& world, State& state, int w, int object) {
  const int row = w * world.objects + object;
  if (world.wander[object]) return draw_wander_goal(world, state, w, object);
  GoalQueue& queue = state.goals[row];
  if (!world.loop[object] || queue.initial.empty()) return;
  queue.set(queue.initial);
  if (queue.initial.size() == 1) {
    const Pose& start = state.initial_pose[row];
    queue.goals[0].theta = world.state_arrival[object] ? queue.goals[0].theta : kNone;
    queue.goals.push_back({start.x, start.y, world.state_arrival[object] ? start.theta : kNone});
  }
  state.sync_goal(row);
}

void command_velocity(const World& world, State& state, int w, int object, Vec2 velocity, const Turning& turning) {
  const int row = w * world.objects + object;
  Vec3& command = state.command[row];
  // An object that goes by an estimate means a direction as it believes to be turned.
  const double turn = estimates(world, object) ? state.pose[row].theta - believed_pose(world, state, row).theta : 0.0;
  command = control_for(world, state, w, object, turn == 0.0 ? velocity : rotate(velocity, unit(turn)), turning);
  if (world.state_arrival[object]) face_goal(world, state, row, object, command);
}

Vec3 control_for(const World& world, const State& state, int w, int object, Vec2 velocity, const Turning& wanted) {
  const int row = w * world.objects + object;
  Turning turning = wanted;
  turning.acce = state.acce[row][1], turning.dt = world.step_time;
  const Wish wish{velocity, state.pose[row], &state.extra[static_cast<std::size_t>(row) * state.extra_rows],
                  state.heading(row), turning};
  Vec3 control{
      {velocity.x, velocity.y, 0.0}};  // for drives in Python, which turn the velocity into controls themselves
  with(world.drive[object], [&](const auto& drive) { control = follow(drive, wish); });
  return control;
}

void decide(const World& world, State& state, int w, Workspace& work) {
  const int first = w * world.objects;
  work.forget_step();
  for (const int i : world.moving) {
    const int row = first + i;
    if (state.stopped[row]) continue;
    if (state.arrived[row]) renew_goals(world, state, w, i);
    if (!state.given[row]) state.command[row] = {};
  }
  find_routes(world, state, w, work);
  for (const BehaviorGroup& group : world.behaviors) {
    work.objects.clear();
    for (const int i : group.objects) {
      if (!is_idle(world, state, first, i) && !state.given[first + i] && !believes(world, i)) work.objects.push_back(i);
    }
    if (!work.objects.empty()) run_behavior(world, state, w, group, work);
    if (!world.perception.empty()) run_believers(world, state, w, group, work);
  }
  keep_routes(world, state, w, work);
}

void decide(const World& world, State& state, int w, Workspace& work, int object) {
  work.forget_step();
  state.command[w * world.objects + object] = {};
  find_routes(world, state, w, work, object);
  for (const BehaviorGroup& group : world.behaviors) {
    if (std::find(group.objects.begin(), group.objects.end(), object) == group.objects.end()) continue;
    const Belief belief(world, state, w, object, work, work.replaced);
    work.objects.assign(1, object);
    run_behavior(world, state, w, group, work);
  }
  keep_routes(world, state, w, work, object);
}

}  // namespace irsim
