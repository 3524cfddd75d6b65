// Arrival at goals and waypoints.
#include "phases.hpp"

namespace irsim {
namespace {

bool at_goal(const World& world, int object, const Pose& pose, const Goal& goal) {
  const double dx = pose.x - goal.x, dy = pose.y - goal.y;
  const bool with_heading = world.state_arrival[object] && !std::isnan(goal.theta);
  const double turn = with_heading ? wrap(pose.theta - goal.theta) : 0.0;
  return std::sqrt(dx * dx + dy * dy + turn * turn) < world.goal_threshold[object];
}

}  // namespace

void arrive(const World& world, State& state, int w) {
  const int first = w * world.objects;
  for (int i = 0; i < world.objects; ++i) {
    const int row = first + i;
    if (std::isnan(state.goal[row].x)) {
      state.arrived[row] = 0;
      continue;
    }
    const Pose& pose = state.pose[row];
    if (!at_goal(world, i, pose, state.goal[row])) {
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
    }
  }
}

}  // namespace irsim
