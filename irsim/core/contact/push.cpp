#include "contact/push.hpp"

namespace irsim {

void shift(const World& world, State& state, int row, Vec2 by, double turn, Vec2 centroid) {
  const int object = row % world.objects;
  Pose& pose = state.pose[row];
  if (turn != 0.0) {
    const Vec2 before = rotate(centroid, state.heading(row));
    pose.theta = into_range(wrap(pose.theta + turn), world.angle_low[object], world.angle_high[object]);
    state.direction[row] = unit(pose.theta);
    state.direction_of[row] = pose.theta;
    const Vec2 swung = before - rotate(centroid, state.direction[row]);
    pose.x += swung.x, pose.y += swung.y;
  }
  pose.x += by.x, pose.y += by.y;
}

void push(const World& world, State& state, int row, Vec2 change, double yaw_rate) {
  const int object = row % world.objects;
  Vec3 &twist = state.twist[row], &control = state.control[row];
  twist[0] += change.x, twist[1] += change.y, twist[2] += yaw_rate;
  if (!world.dynamics[object].driven) {
    control[0] += change.x, control[1] += change.y, control[2] += yaw_rate;
    return;
  }
  const Vec2 body = unrotate(change, state.heading(row));
  with(world.drive[object], [&](const auto& drive) {
    const Rows which = rows(drive);
    control[0] += body.x;
    if (which.travel > 1) control[1] += body.y;
    if (which.yaw >= 0) control[which.yaw] += yaw_rate;
  });
}

}  // namespace irsim
