// Arrival at goals and waypoints.
#include <variant>

#include "geometry/predicates.hpp"
#include "phases.hpp"
#include "world/spec.hpp"

namespace irsim {
namespace {

bool at_goal(const World& world, int object, const Pose& pose, const Goal& goal) {
  const double dx = pose.x - goal.x, dy = pose.y - goal.y;
  const bool with_heading = world.state_arrival[object] && !std::isnan(goal.theta);
  const double turn = with_heading ? wrap(pose.theta - goal.theta) : 0.0;
  return std::sqrt(dx * dx + dy * dy + turn * turn) < world.goal_threshold[object];
}

bool same_goal(const Goal& a, const Goal& b) {
  const auto same = [](double p, double q) { return p == q || (std::isnan(p) && std::isnan(q)); };
  return same(a.x, b.x) && same(a.y, b.y) && same(a.theta, b.theta);
}

void note_standings(const World& world, State& state, int w) {
  for (const int i : world.moving) {
    const int row = w * world.objects + i;
    std::vector<Standing>& past = state.standings[row];
    const Standing now{state.count[w], state.goal[row], state.stopped[row]};
    if (past.empty() || past.back().stopped != now.stopped || !same_goal(past.back().goal, now.goal))
      past.push_back(now);
  }
}

/// Whether an object has arrived for good: a robot with nowhere else to go, where the world says so.
bool is_settled(const World& world, const State& state, int row, int object) {
  return world.after_arrival != kUnlatched && state.arrived[row] && world.is_robot[object] && !world.wander[object] &&
         !world.loop[object];
}

/// Whether an object is on its recorded way to its goal: it may pass that place before its recording ends.
bool replays(const World& world, const State& state, int w, int object) {
  const auto* recording = std::get_if<ReplayOptions>(&world.specs[object].behavior);
  if (!recording || recording->times.empty()) return false;
  const Goal& goal = state.goal[w * world.objects + object];
  if (recording->poses.back()[0] != goal.x || recording->poses.back()[1] != goal.y) return false;
  constexpr double kRounding = 1e-9;  // of a number of steps
  return static_cast<double>(state.count[w] + 1) <= recording->times.back() / world.step_time + kRounding;
}

/// Whether an object that came from `from`, and is not at its goal, passed it in this step and was not at it before.
bool overshoots(const World& world, const State& state, int row, int object, Vec2 from) {
  const Vec2 to = state.pose[row].position(), at = state.goal[row].position();
  if (dot(at - to, to - from) >= 0.0) return false;  // it is still ahead
  if (world.is_static[object] || world.state_arrival[object] || state.overshot[row]) return false;
  const double threshold = world.goal_threshold[object];
  return norm(from - at) >= threshold && norm(nearest_on_segment(from, to, at) - at) < threshold;
}

}  // namespace

void arrive(const World& world, State& state, int w) {
  const int first = w * world.objects;
  for (int i = 0; i < world.objects; ++i) {
    const int row = first + i;
    const Vec2 from = state.before[row].position();
    state.before[row] = state.pose[row];
    if (std::isnan(state.goal[row].x)) {
      state.arrived[row] = 0;
      continue;
    }
    if (replays(world, state, w, i)) {
      state.arrived[row] = 0;
      continue;
    }
    const Pose& pose = state.pose[row];
    if (state.arrived[row] && is_settled(world, state, row, i)) {
      if (world.after_arrival == kFreeze) state.stopped[row] = 1;
      continue;
    }
    if (!at_goal(world, i, pose, state.goal[row])) {
      if (!state.arrived[row] && overshoots(world, state, row, i, from)) {
        state.log(world, w, EventKind::overshoot, i, -1, pose.position());
        state.overshot[row] = 1;
      }
      state.arrived[row] = 0;
      continue;
    }
    GoalQueue& queue = state.goals[row];
    if (queue.left() > 1) {
      ++queue.head;
      state.sync_goal(row);
      state.arrived[row] = 0;
      state.log(world, w, EventKind::waypoint, i, -1, pose.position());
    } else {
      if (!state.arrived[row]) state.log(world, w, EventKind::arrival, i, -1, pose.position());
      state.arrived[row] = 1;
      if (world.after_arrival == kFreeze && is_settled(world, state, row, i)) state.stopped[row] = 1;
    }
  }
  if (state.keep_history) note_standings(world, state, w);
}

}  // namespace irsim
