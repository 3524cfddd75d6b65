// Which velocity an object with `footprint_orca` takes: the best of some tens, as in a dynamic window (Fox, Burgard,
// Thrun: The dynamic window approach to collision avoidance, 1997), by the time to a collision as for reciprocal
// velocity obstacles (van den Berg, Lin, Manocha: Reciprocal velocity obstacles for real-time multi-agent navigation,
// 2008). Only controls that leave the object within its cell are taken.
#include <algorithm>

#include "footprints/decider.hpp"
#include "surroundings/goal_heading.hpp"

namespace irsim {
namespace {

constexpr double kMinSpeed = 1e-6;       // slower velocities are rounding errors [m/s]
constexpr double kSoon = 0.1;            // added to the time to a collision, so that none weighs infinitely much [s]
constexpr double kMoverWeight = 0.5;     // cost of a collision with a mover in a second, roughly [s]
constexpr double kStandingWeight = 0.2;  // cost of a collision with what stands in a second, roughly [s]
constexpr double kTurnWeight = 0.15;     // cost of a velocity at a right angle to the heading
constexpr double kLeftWeight = 0.02;     // cost of a velocity at a right angle to the left of the wanted one
constexpr double kStopWeight = 0.3;      // cost of standing, besides the way that it loses
constexpr double kKeepDirection = 0.3;   // angle beyond a right angle before forward and backward are swapped [rad]
constexpr double kMinCarShare = 0.3;     // smallest share of a wanted speed of a car, which turns only while it rolls

constexpr double kMostSteering = 0.25 * kPi;  // largest steering angle that is used [rad]
constexpr double kStraightOn = 0.98;          // cosine of the angle at which a velocity leads to the goal
constexpr double kOutside = 0.05;             // how far outside the turning circles of a car its goal must be then [m]

constexpr double kLeastGain = 1e-6;  // smaller gains of a small step are rounding errors

constexpr double kRoot = 0.86602540378443865;  // cosine of 30 degrees
/// Cosines and sines of the directions that are tried, seen from the wanted one: nearest first, right before left.
constexpr Vec2 kDirections[] = {{1.0, 0.0}, {kRoot, -0.5},  {kRoot, 0.5},  {0.5, -kRoot},  {0.5, kRoot},  {0.0, -1.0},
                                {0.0, 1.0}, {-0.5, -kRoot}, {-0.5, kRoot}, {-kRoot, -0.5}, {-kRoot, 0.5}, {-1.0, 0.0}};

/// A control, and how far the object keeps off others with it.
struct Trial {
  Vec3 control;
  Vec2 velocity;
  double room = -kInfinity;
};

/// The smallest amount by which the object keeps its distance from strangers with a control; minus infinity if the step
/// and the stop after it leave its cell, or touch what stands [m].
double room_with(FootprintSelf& self, Vec3 control) {
  FootprintCrowd& crowd = self.crowd;
  if (crowd.cell.empty()) return kInfinity;
  self.ahead.step_and_stop(self.ahead.limited(control), crowd.way);
  const CellBody body{self.hull, self.position};
  return crowd.cell.holds(body, crowd.way) ? crowd.cell.room(body, crowd.way) : -kInfinity;
}

/// The same for braking. It is always within the cell: the border of two bodies runs between the hulls of their stops,
/// and the control before was taken only because the stop after it is free.
double room_of_stop(FootprintSelf& self) {
  FootprintCrowd& crowd = self.crowd;
  if (crowd.cell.empty()) return kInfinity;
  self.ahead.step_and_stop(self.ahead.limited(self.ahead.braking()), crowd.way);
  return crowd.cell.room({self.hull, self.position}, crowd.way);
}

/// Forward or backward, and the heading error that is left.
struct Course {
  double sign, error;
};
Course course_to(const FootprintSelf& self, Vec2 velocity) {
  const double error = std::atan2(cross(self.heading, velocity), dot(self.heading, velocity));
  if (!self.reverses) return {1.0, error};
  const double limit = 0.5 * kPi + (self.state().control[self.row][0] < 0.0 ? -kKeepDirection : kKeepDirection);
  return std::fabs(error) > limit ? Course{-1.0, wrap(error + kPi)} : Course{1.0, error};
}

/// Whether a car must drive away from its goal first, and forward (1) or backward (-1): no arc leads to places well
/// inside its turning circles. 0 if it need not, or if the velocity leads elsewhere.
double leaves_goal(const FootprintSelf& self, const Car& car, double wheelbase, Vec2 velocity) {
  const State& state = self.state();
  double steering = std::min(car.psi_max, kMostSteering);
  if (car.mode == Steering::steer) steering = std::min(steering, state.vel_max[self.row][1]);
  if (!(steering > 0.0) || std::isnan(state.goal[self.row].x)) return 0.0;
  const double radius = wheelbase / std::tan(steering);
  const Vec2 way = state.destination(self.row).position() - self.position, goal = unrotate(way, self.heading);
  if (dot(velocity, way) < kStraightOn * norm(velocity) * norm(way)) return 0.0;
  const double inside = radius - norm({goal.x, std::fabs(goal.y) - radius});
  const double away = goal.x < 0.0 || !self.reverses ? 1.0 : -1.0;
  const bool leaving = state.control[self.row][0] * away > 0.0;
  return inside > (leaving ? -kOutside : 0.5 * self.world().goal_threshold[self.object]) ? away : 0.0;
}

Vec3 car_control(const FootprintSelf& self, const Car& car, Vec2 velocity) {
  const State& state = self.state();
  const double psi = state.extra[static_cast<std::size_t>(self.row) * state.extra_rows];
  const double wheelbase = car.wheelbase > 0.0 ? car.wheelbase : 1.0, dt = self.world().step_time;
  const double speed = norm(velocity);
  if (speed < kMinSpeed) return {{0.0, car.mode == Steering::steer ? psi : 0.0, 0.0}};
  const double away = self.limits().glides ? leaves_goal(self, car, wheelbase, velocity) : 0.0;
  if (away != 0.0) return {{away * speed, car.mode == Steering::steer ? 0.0 : -psi / dt, 0.0}};
  const Course course = course_to(self, velocity);
  const double rolls = course.sign * speed * std::max(kMinCarShare, std::cos(course.error));
  const double target =
      clip(car.angle_for(course.error * wheelbase / (rolls * 2.0 * dt)), -kMostSteering, kMostSteering);
  return {{rolls, car.mode == Steering::steer ? target : (target - psi) / dt, 0.0}};
}

/// The control of a car with a steering angle, and the angle by which it then turns in some steps.
Vec3 steered(const FootprintSelf& self, const Car& car, double speed, double steering, double& angle) {
  constexpr double kSteps = 5.0;
  const double wheelbase = car.wheelbase > 0.0 ? car.wheelbase : 1.0, dt = self.world().step_time;
  const double psi = self.state().extra[static_cast<std::size_t>(self.row) * self.state().extra_rows];
  const double target = clip(steering, -kMostSteering, kMostSteering);
  angle = kSteps * speed * dt * car.yaw(target) / wheelbase;
  return {{speed, car.mode == Steering::steer ? target : (target - psi) / dt, 0.0}};
}

/// The control with which the object takes up a velocity.
Vec3 control_toward(const FootprintSelf& self, Vec2 velocity) {
  const World& world = self.world();
  const State& state = self.state();
  const Drive& drive = world.drive[self.object];
  const double speed = norm(velocity), dt = world.step_time;
  if (const std::optional<Car> car = car_of(drive)) return car_control(self, *car, velocity);
  if (turns_in_place(drive)) {
    if (speed < kMinSpeed) return {};
    const Course course = course_to(self, velocity);
    const double most = std::min(state.vel_max[self.row][1],
                                 speed_to_stop_within(std::fabs(course.error), state.acce[self.row][1], dt));
    return {{course.sign * speed * std::max(0.0, std::cos(course.error)), clip(course.error / dt, -most, most), 0.0}};
  }
  const Turning turning{kMinSpeed, 0.0, dt, state.vel_max[self.row][1], kInfinity};
  const Wish wish{velocity, state.pose[self.row], &state.extra[static_cast<std::size_t>(self.row) * state.extra_rows],
                  self.heading, turning};
  Vec3 control{{velocity.x, velocity.y, 0.0}};
  with(drive, [&](const auto& one) { control = follow(one, wish); });
  return control;
}

/// The search for the best velocity.
class BestVelocity {
 public:
  BestVelocity(FootprintSelf& self, Vec2 wanted) : self_(self), wanted_(norm(wanted)) {
    ahead_ = wanted_ > 0.0 ? wanted * (1.0 / wanted_) : self.heading;
    rate_ = self.speed > 0.0 ? 1.0 / self.speed : 0.0;
  }
  /// Keep a velocity if it is better than those before it and leads nowhere else than into the cell.
  void consider(Vec2 velocity) {
    const double cost = cost_of(velocity);
    if (!(cost < cost_)) return;
    offer(velocity, control_toward(self_, velocity), cost);
  }
  /// The same for driving straight ahead or back.
  void consider_straight(double speed) {
    const Vec2 velocity = self_.heading * speed;
    const double cost = cost_of(velocity);
    if (cost < cost_) offer(velocity, {{speed, 0.0, 0.0}}, cost);
  }
  /// The same for braking as hard as possible.
  void consider_stop() {
    const double cost = cost_of({});
    if (cost < cost_) keep({self_.ahead.braking(), {}, room_of_stop(self_)}, cost);
  }
  /// Turn or move a little toward the wanted direction, if the object would stand otherwise: a body that is wedged
  /// between others gets free in small steps.
  void inch() {
    const std::optional<Car> car = car_of(self_.world().drive[self_.object]);
    const bool turns = self_.turn_rate > 0.0 || car.has_value();
    if (!(wanted_ > 0.0) || !turns || squared(best_.velocity) > kMinSpeed || best_.room < 0.0) return;
    double most = aligned(self_.heading) + kLeastGain;
    for (const double share : {0.0, 0.03, -0.03, 0.1, -0.1, 0.3, -0.3}) {
      if (share < 0.0 && !self_.reverses) continue;
      const double speed = share * self_.speed;
      for (const double turn : {0.0, 0.01, -0.01, 0.03, -0.03, 0.1, -0.1, 0.4, -0.4}) {
        Vec3 control{{speed, turn * self_.turn_rate, 0.0}};
        double angle = control[1] * self_.world().step_time;
        if (car) control = steered(self_, *car, speed, kPi * turn, angle);
        const double gain = aligned(rotate(self_.heading, unit(angle))) + speed * dot(self_.heading, ahead_) * rate_;
        if (gain <= most) continue;
        const double room = room_with(self_, control);
        if (room >= 0.0) best_ = {control, self_.heading * speed, room}, most = gain;
      }
    }
  }
  /// Turn to the heading of the goal while the object stands at it, as far as its cell allows.
  void face_goal() {
    const World& world = self_.world();
    const State& state = self_.state();
    const Vec2 way = state.goal[self_.row].position() - self_.position;
    if (!turns_in_place(world.drive[self_.object]) || !turns_at_goal(world, state, self_.row, self_.object) ||
        !(norm(way) < world.goal_threshold[self_.object]))
      return;
    const double rate = yaw_rate_to_goal(world, state, self_.row, self_.object);
    for (const double share : {1.0, 0.5, 0.25}) {
      const Vec3 control{{0.0, share * rate, 0.0}};
      const double room = room_with(self_, control);
      if (!(room >= 0.0)) continue;
      best_ = {control, {}, room};
      return;
    }
  }
  /// Whether nothing can be better.
  bool is_perfect() const { return cost_ <= 0.0; }
  Intent intent() const {
    const Drive& drive = self_.world().drive[self_.object];
    Intent intent = std::holds_alternative<std::monostate>(drive) ? Intent::of_velocity(best_.velocity)
                                                                  : Intent::of_control(best_.control);
    intent.infeasible = best_.room < 0.0;
    intent.final = turns_in_place(drive);
    return intent;
  }

 private:
  double aligned(Vec2 heading) const {
    const double cosine = dot(heading, ahead_);
    return self_.reverses ? std::fabs(cosine) : cosine;
  }
  void offer(Vec2 velocity, Vec3 control, double cost) { keep({control, velocity, room_with(self_, control)}, cost); }
  void keep(const Trial& trial, double cost) {
    if (trial.room >= 0.0) {
      best_ = trial, cost_ = cost;
    } else if (trial.room > best_.room && best_.room < 0.0) {
      best_ = trial;
    }
  }

  /// The cost of a velocity: its loss on the way to the goal, plus its risk. The sum stops where it exceeds the best so
  /// far.
  double cost_of(Vec2 velocity) const {
    const double speed = norm(velocity);
    double cost = wanted_ > 0.0 ? 1.0 - dot(velocity, ahead_) * rate_ + kStopWeight * (1.0 - speed * rate_) : speed;
    cost += kLeftWeight * std::max(0.0, cross(ahead_, velocity)) * rate_;
    if (!self_.slides && speed > kMinSpeed) {
      const double cosine = dot(velocity, self_.heading) / speed;
      cost += kTurnWeight * (1.0 - (self_.reverses ? std::fabs(cosine) : cosine));
    }
    double moving = 0.0, still = 0.0;
    for (const Threat& threat : self_.crowd.threats) {
      if (cost + moving + still >= cost_) return kInfinity;
      const double time = threat.cone.time(velocity * threat.gain - threat.base, self_.crowd.faces.data());
      if (time >= threat.horizon) continue;
      const double urgency = 1.0 / (time + kSoon) - 1.0 / (threat.horizon + kSoon);
      double& most = threat.standing ? still : moving;
      most = std::max(most, urgency * (threat.standing ? kStandingWeight : kMoverWeight));
    }
    return cost + moving + still;
  }

  FootprintSelf& self_;
  double wanted_, rate_;
  Vec2 ahead_;
  Trial best_;
  double cost_ = kInfinity;
};

}  // namespace

Intent best_intent(FootprintSelf& self, Vec2 wanted) {
  BestVelocity choice(self, wanted);
  choice.consider(wanted);
  if (choice.is_perfect()) {
    if (!(squared(wanted) > 0.0)) choice.face_goal();
    return choice.intent();
  }
  const double speed = norm(wanted);
  const Vec2 ahead = speed > 0.0 ? wanted * (1.0 / speed) : self.heading;
  for (const Vec2 turn : kDirections) {
    for (const double share : {1.0, 0.5}) choice.consider(rotate(ahead, turn) * (share * self.speed));
  }
  if (!self.slides) {
    for (const double share : {1.0, 0.5, 0.15}) {
      choice.consider_straight(share * self.speed);
      if (self.reverses) choice.consider_straight(-share * self.speed);
    }
  }
  choice.consider_stop();
  choice.inch();
  return choice.intent();
}

}  // namespace irsim
