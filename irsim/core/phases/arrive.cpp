// Arrival at goals and waypoints.
#include <variant>

#include "geometry/predicates.hpp"
#include "phases.hpp"
#include "surroundings/perception.hpp"
#include "world/spec.hpp"

namespace irsim {
namespace {

bool at_goal(const World& world, int object, const Pose& pose, const Goal& goal, double threshold) {
  const double dx = pose.x - goal.x, dy = pose.y - goal.y;
  const bool with_heading = world.state_arrival[object] && !std::isnan(goal.theta);
  const double turn = with_heading ? wrap(pose.theta - goal.theta) : 0.0;
  return std::sqrt(dx * dx + dy * dy + turn * turn) < threshold;
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

/// Whether an object goes on to other goals for ever.
bool is_endless(const World& world, int object) { return world.wander[object] || world.loop[object]; }

/// Whether an object arrives for good: a robot with nowhere else to go, where the world says so.
bool settles(const World& world, int object) {
  return world.after_arrival != kUnlatched && world.is_robot[object] && !is_endless(world, object);
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

/// The arrival of an object that goes by an estimate: it goes on to its next goal, and rests, where it believes to be
/// there; whether it has arrived is the truth.
void arrive_in_belief(const World& world, State& state, int w, int object) {
  const int row = w * world.objects + object;
  const Goal& goal = state.goal[row];
  const Pose& pose = state.pose[row];
  std::uint8_t &arrived = state.arrived[row], &rests = state.believes_arrived[row];
  const bool for_good = settles(world, object);
  constexpr double kStanding = 1e-3;  // slower objects stand [m/s]
  const double judged = world.specs[object].goal_threshold;
  const bool stands = std::hypot(state.twist[row][0], state.twist[row][1]) < kStanding;
  const bool believed =
      at_goal(world, object, believed_pose(world, state, row), goal, stands ? judged : world.goal_threshold[object]);
  if (state.goals[row].left() > 1) {
    arrived = 0;
    if (!believed) return;
    ++state.goals[row].head;
    state.sync_goal(row);
    return state.log(world, w, EventKind::waypoint, object, -1, pose.position());
  }
  const bool endless = is_endless(world, object);
  const bool there = endless ? believed : at_goal(world, object, pose, goal, judged);
  if (believed && !rests && !endless) state.log(world, w, EventKind::believed_arrival, object, -1, pose.position());
  if (there && !arrived) state.log(world, w, EventKind::arrival, object, -1, pose.position());
  rests = believed || (rests && for_good);
  arrived = there || (arrived && for_good);
  if (rests && for_good && world.after_arrival == kFreeze) state.stopped[row] = 1;
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
    if (estimates(world, i)) {
      arrive_in_belief(world, state, w, i);
      continue;
    }
    const Pose& pose = state.pose[row];
    if (state.arrived[row] && settles(world, i)) {
      if (world.after_arrival == kFreeze) state.stopped[row] = 1;
      continue;
    }
    if (!at_goal(world, i, pose, state.goal[row], world.goal_threshold[i])) {
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
      if (world.after_arrival == kFreeze && settles(world, i)) state.stopped[row] = 1;
    }
  }
  if (state.keep_history) note_standings(world, state, w);
}

}  // namespace irsim
