// Driving along legs: poses for bodies that must turn in narrow places.
#include "routes/follower.hpp"

namespace irsim {
namespace {

constexpr double kLegEnd = 0.01;       // a leg with less than this left is finished [m], or [rad] of a turn
constexpr double kLegGain = 2.0;       // gain of turning back to the line of a leg [1/s], [rad/(m s)]
constexpr double kParkingShare = 0.5;  // part of the way ahead in which the wheels of a car that parks turn
constexpr int kMaxBlockedSteps = 30;   // a leg that is blocked for more steps than this is planned again

}  // namespace

double Follower::max_steering(const Car& car) const {
  const double psi = std::min(steering_range(car), 1.4);
  return car.mode == Steering::steer ? std::min(psi, state_.vel_max[row_][1]) : psi;
}

void Follower::follow_legs(Vec3& u) {
  if (steers(world_.drive[object_])) {
    follow_legs_by_pursuit(u);
  } else {
    follow_legs_in_place(u);
  }
  if (route_.leg >= route_.legs.size()) {  // from the last pose the goal is reached in a straight line
    route_.legs.clear();
    if (route_.retreats) {
      u = {};
      return;
    }
    route_.path = {position(), route_.goal};
    route_.next = 1;
    return;
  }
  if (route_.retreats) find_sides();
  const bool found = slow_down_on_leg(u);
  work_.sides.clear();
  if (found) {
    route_.blocked_steps = 0;
    return;
  }
  u = {};
  if (steers(world_.drive[object_])) hold_steering(u);
  if (++route_.blocked_steps > kMaxBlockedSteps && !route_.retreats) {
    route_.blocked_steps = 0;
    plan();
  }
}

bool Follower::slow_down_on_leg(Vec3& u) {
  const std::optional<Car> car = car_of(world_.drive[object_]);
  const double psi = !car ? 0.0 : state_.extra[static_cast<std::size_t>(row_) * state_.extra_rows];
  const double most = !car ? 0.0 : max_steering(*car);
  // A retreat need not follow the track closely: a car may turn away from what is beside it.
  for (const double turn : {0.0, 0.3, -0.3, 0.8, -0.8}) {
    if (turn != 0.0 && (!car || !route_.retreats)) break;
    for (const double share : {1.0, 0.5, 0.25, 0.1}) {
      Vec3 v = u;
      v[0] *= share;
      if (!car) v[1] *= share;
      if (turn != 0.0) {
        const double planned = car->mode == Steering::steer ? v[1] : psi + v[1] * world_.step_time;
        const double wanted = clip(planned + turn, -most, most);
        v[1] = car->mode == Steering::steer ? wanted : (wanted - psi) / world_.step_time;
      }
      if (!clear_after(v)) continue;
      u = v;
      return true;
    }
  }
  return false;
}

double Follower::stopping_speed(double left, int control, double most) const {
  const double dt = world_.step_time, stopping = speed_to_stop_within(left, state_.acce[row_][control], dt);
  return std::max(std::min({most, left / dt, stopping}), 0.0);
}

double Follower::top_speed(int way) const {
  return way > 0 ? state_.vel_max[row_][0] : std::fabs(state_.vel_min[row_][0]);
}

void Follower::follow_legs_in_place(Vec3& u) {
  const Pose& pose = state_.pose[row_];
  std::vector<Leg>& legs = route_.legs;
  for (; route_.leg < legs.size(); ++route_.leg) {
    const Leg& leg = legs[route_.leg];
    u = {};
    if (leg.way == 0) {
      const double error = wrap(leg.pose.theta - pose.theta);
      if (std::fabs(error) < kLegEnd) continue;
      const double rate = stopping_speed(std::fabs(error), 1, std::fabs(state_.vel_max[row_][1]));
      u[1] = error > 0.0 ? rate : -rate;
      return;
    }
    const Vec2 along = unit(leg.pose.theta), gap = leg.pose.position() - pose.position();
    const double left = leg.way * dot(gap, along);
    if (left < kLegEnd) continue;
    const double most = std::fabs(state_.vel_max[row_][1]);
    u[0] = leg.way * stopping_speed(left, 0, top_speed(leg.way));
    u[1] = clip(-kLegGain * (wrap(pose.theta - leg.pose.theta) + leg.way * cross(gap, along)), -most, most);
    return;
  }
}

void Follower::follow_legs_by_pursuit(Vec3& u) {
  const Car car = *car_of(world_.drive[object_]);
  const Pose& pose = state_.pose[row_];
  const std::vector<Leg>& legs = route_.legs;
  u = {};
  while (route_.leg < legs.size()) {
    const int way = legs[route_.leg].way;
    std::size_t last = route_.leg;
    while (last + 1 < legs.size() && legs[last + 1].way == way) ++last;
    const double ahead = std::max(0.15, 0.6 * car.wheelbase);
    while (route_.leg < last && norm(legs[route_.leg].pose.position() - pose.position()) < ahead) ++route_.leg;
    Vec2 gap = legs[route_.leg].pose.position() - pose.position();
    double left = kInfinity;
    if (route_.leg == last) {
      const Vec2 along = unit(legs[last].pose.theta);
      left = way * dot(gap, along);
      if (left < kLegEnd) {
        ++route_.leg;
        continue;
      }
      const double short_by = ahead - norm(gap);
      if (short_by > 0.0) gap = gap + along * (way * short_by);
    }
    const Vec2 point = unrotate(gap, state_.heading(row_));
    const double most = max_steering(car);
    const double psi = clip(std::atan(2.0 * point.y / squared(point) * car.wheelbase), -most, most);
    const double now = state_.extra[static_cast<std::size_t>(row_) * state_.extra_rows];
    double fastest = std::min(top_speed(way), 0.4 * ahead / world_.step_time);
    if (parks()) {  // the wheels must get to where they are wanted, or turn half round, within a short way
      const double rate = car.mode == Steering::steer ? state_.acce[row_][1] : state_.vel_max[row_][1];
      const double turn = std::max(std::fabs(psi - now), most);
      if (rate > 0.0) fastest = std::min(fastest, kParkingShare * ahead * rate / turn);
    }
    u[0] = way * stopping_speed(left, 0, fastest);
    u[1] = car.mode == Steering::steer ? psi : (psi - now) / world_.step_time;
    return;
  }
}
}  // namespace irsim
