#include "contact/respond.hpp"

namespace irsim {

Vec3 respond(const World& world, State& state, int row, Vec3 command) {
  const int object = row % world.objects;
  if (!is_native(world.drive[object])) return command;  // the drive is in Python
  const BodyDynamics& dynamics = world.dynamics[object];
  Vec3& c = state.drive[row];
  if (world.unstoppable[object]) return c = command;
  Vec3 target = command;
  if (dynamics.tau > 0.0) {
    const double part = std::min(1.0, world.step_time / dynamics.tau);
    for (int k = 0; k < 3; ++k) target[k] = c[k] + part * (command[k] - c[k]);
  }
  with(world.drive[object], [&](const auto& drive) {
    const int travel = rows(drive).travel;
    double change2 = 0.0;
    for (int k = 0; k < travel; ++k) change2 += (target[k] - c[k]) * (target[k] - c[k]);
    const double most = dynamics.friction * world.gravity * world.step_time, change = std::sqrt(change2);
    if (!(change > most)) return;
    for (int k = 0; k < travel; ++k) target[k] = c[k] + (target[k] - c[k]) * (most / change);
  });
  return c = target;
}

Vec3 without_command(const World& world, State& state, int row) {
  const int object = row % world.objects;
  const BodyDynamics& dynamics = world.dynamics[object];
  if (dynamics.driven) return world.collision_mode == kContact ? respond(world, state, row, {}) : Vec3{};
  Vec3 u = state.control[row];
  const double speed = norm({u[0], u[1]}), slower = dynamics.friction * world.gravity * world.step_time;
  const double kept = speed > slower ? (speed - slower) / speed : 0.0;
  u[0] *= kept, u[1] *= kept;
  if (u[2] == 0.0) return u;
  const Bodies& bodies = bodies_of(world, state, row / world.objects);
  const double i = bodies.inverse_inertia[object],
               gyration = i > 0.0 ? std::sqrt(bodies.inverse_mass[object] / i) : 0.0;
  const double rate = std::fabs(u[2]), less = gyration > 0.0 ? slower / gyration : 0.0;
  u[2] = rate > less ? std::copysign(rate - less, u[2]) : 0.0;
  return u;
}

void coast(const World& world, State& state, int row) {
  const Vec3& u = state.control[row];
  Pose& pose = state.pose[row];
  pose.x += u[0] * world.step_time;
  pose.y += u[1] * world.step_time;
  pose.theta = wrap(pose.theta + u[2] * world.step_time);
  state.twist[row] = u;
  const int object = row % world.objects;
  pose.theta = into_range(pose.theta, world.angle_low[object], world.angle_high[object]);
}

}  // namespace irsim
