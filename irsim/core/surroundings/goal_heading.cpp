#include "surroundings/goal_heading.hpp"

#include <algorithm>

#include "world/spec.hpp"

namespace irsim {
namespace {

constexpr double kRestingTurn = 1e-9;      // an object that turns by less in a step counts as resting [rad]
constexpr double kHarmlessSpeed = 0.05;    // slower objects run into nothing [m/s]
constexpr double kCollisionHorizon = 2.0;  // collisions that would come later are not avoided yet [s]

/// Whether another object that moves on as now runs into this one within the horizon if it stands.
bool is_run_into(const World& world, const State& state, int row, int object) {
  const Shapes& shapes = *state.scenes[row / world.objects].shapes;
  const auto centre_of = [&](int at, int i) {
    return state.pose[at].position() + rotate(shapes.centre[i], state.heading(at));
  };
  const Vec2 here = centre_of(row, object);
  return std::any_of(world.moving.begin(), world.moving.end(), [&](int i) {
    const int other = row - object + i;
    if (i == object || world.unobstructed[i] || state.absent(other)) return false;
    const Vec2 velocity{state.twist[other][0], state.twist[other][1]};
    const double speed2 = squared(velocity);
    if (speed2 < kHarmlessSpeed * kHarmlessSpeed) return false;
    const Vec2 gap = here - centre_of(other, i);
    const double closing = dot(gap, velocity), reach = shapes.radius[i] + shapes.radius[object];
    const double apart = squared(gap) - reach * reach, root = closing * closing - speed2 * apart;
    if (closing <= 0.0 || root < 0.0) return false;
    return apart <= 0.0 || closing - std::sqrt(root) <= kCollisionHorizon * speed2;
  });
}

}  // namespace

bool turns_at_goal(const World& world, const State& state, int row, int object) {
  if (!world.state_arrival[object] || std::isnan(state.goal[row].theta)) return false;
  const Drive& drive = world.drive[object];
  return turns_in_place(drive) || std::holds_alternative<OmniAngularOptions>(drive);
}

double speed_to_goal(const World& world, const State& state, int row) {
  const double gap = norm(state.goal[row].position() - state.pose[row].position());
  return speed_to_stop_within(gap, state.acce[row][0], world.step_time);
}

double yaw_rate_to_goal(const World& world, const State& state, int row, int object) {
  const int yaw = turns_in_place(world.drive[object]) ? 1 : 2;
  const double error = wrap(state.goal[row].theta - state.pose[row].theta), dt = world.step_time;
  const double left = std::fabs(error),
               rate = std::min(left / dt, speed_to_stop_within(left, state.acce[row][yaw], dt));
  return error > 0.0 ? rate : -rate;
}

namespace {

/// `diff` brakes before its goal, then it stands and turns, unless it avoids another object.
void brake_and_turn(const World& world, const State& state, int row, int object, Vec3& control) {
  const Vec2 way = state.goal[row].position() - state.pose[row].position();
  const double gap = norm(way), most = speed_to_goal(world, state, row);
  const double toward = control[0] * dot(state.heading(row), way);
  const bool stands = gap<world.goal_threshold[object], brakes = toward> most * gap;
  const bool avoids = !std::holds_alternative<DashOptions>(world.specs[object].behavior);
  if (!(stands || brakes) || (avoids && is_run_into(world, state, row, object))) return;
  if (stands) {
    control = {{0.0, yaw_rate_to_goal(world, state, row, object), 0.0}};
  } else {
    control[0] *= most * gap / toward;
  }
}

}  // namespace

void face_goal(const World& world, const State& state, int row, int object, Vec3& control) {
  if (!turns_at_goal(world, state, row, object)) return;
  if (turns_in_place(world.drive[object])) return brake_and_turn(world, state, row, object, control);
  const double gap = norm(state.goal[row].position() - state.pose[row].position());
  const double threshold = world.goal_threshold[object];
  if (state.arrived[row] || !(gap <= threshold)) return;
  const double error = wrap(state.goal[row].theta - state.pose[row].theta);
  const double turn = std::fabs(control[2]) * world.step_time, enough = std::sqrt(threshold * threshold - gap * gap);
  if (turn > kRestingTurn && turn <= std::fabs(error) + enough) return;
  control[2] = yaw_rate_to_goal(world, state, row, object);
}

}  // namespace irsim
