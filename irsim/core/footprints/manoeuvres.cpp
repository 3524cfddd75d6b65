#include "footprints/manoeuvres.hpp"

#include <algorithm>

#include "braking/stops.hpp"
#include "world/state.hpp"
#include "world/world.hpp"

namespace irsim {
namespace {

constexpr double kCoarseTurn = 0.15;  // largest turn between two places [rad]
constexpr int kMostParts = 32;        // of a step
constexpr int kMostSteps = 100;       // of a stop; what is left then only widens the bulge
constexpr double kStill = 1e-9;       // slower controls are rounding errors
constexpr double kArc = 0.05;         // an arc is longer than its chord by less than this times its squared angle
constexpr double kSteep = 1.4;        // larger steering angles count as this one [rad]
constexpr double kFar = 1e6;          // way of what cannot brake [m]

/// Which components of a control are what, and which of them a stop leaves alone.
struct Components {
  int travel = 0, yaw = -1;
  std::optional<Car> car;
};

Components components_of(const Drive& drive) {
  Components found;
  with(drive, [&](const auto& options) {
    const Rows rows_of = rows(options);
    found.travel = rows_of.travel, found.yaw = rows_of.yaw;
  });
  found.car = car_of(drive);
  return found;
}

double length(double a, double b) { return std::sqrt(a * a + b * b); }

/// Way on which a speed decays by `change` in each step, the first of them included [m].
double stopping_way(double speed, double change, double dt) {
  if (!std::isfinite(change)) return 0.0;
  const double v = std::fabs(speed);
  if (!(change > 0.0)) return v > 0.0 ? std::copysign(kFar, speed) : 0.0;
  const double steps = std::floor(v / change);
  return std::copysign(std::min(kFar, dt * (steps * v - 0.5 * change * steps * (steps + 1.0))), speed);
}

/// One object that moves on.
class Run {
 public:
  Run(const Ahead& ahead, Manoeuvre& out)
      : ahead_(ahead),
        drive_(ahead.world.drive[ahead.object]),
        kind_(components_of(drive_)),
        from_(ahead.state.pose[ahead.row]),
        pose_(from_),
        heading_(ahead.state.heading(ahead.row)),
        start_(heading_),
        dt_(ahead.world.step_time),
        out_(out) {
    const double* rows = &ahead.state.extra[static_cast<std::size_t>(ahead.row) * ahead.state.extra_rows];
    ahead.extra.assign(rows, rows + ahead.state.extra_rows);
    out.clear();
    out.arcs = ahead.world.integration == kExact;
  }

  void step(Vec3 control) {
    const Pose before = pose_;
    Vec3 twist;
    with(drive_, [&](const auto& drive) {
      run(drive, Motion{pose_, ahead_.extra.data(), twist, heading_, control, dt_, ahead_.world.integration});
    });
    const double angle = twist[2] * dt_;
    const int parts = std::clamp(static_cast<int>(std::ceil(std::fabs(angle) / kCoarseTurn)), 1, kMostParts);
    double way = 0.0;
    for (int k = 1; k <= parts; ++k) {
      const double share = static_cast<double>(k) / parts;
      const Pose there = k == parts ? pose_ : pose_at(before, twist, dt_ * share, ahead_.world.integration);
      way = add(there.position() - from_.position(), turned_ + angle * share, steps_ + share);
    }
    turned_ += angle, ++steps_;
    if (angle != 0.0) heading_ = rotate(start_, out_.places.back().turn);
    const double part = std::fabs(angle) / parts;
    const double arc = ahead_.world.integration == kExact ? way : 0.0;
    out_.bulge = std::max(out_.bulge, (ahead_.reach * part + arc) * part * 0.125);
  }

  void stop(Vec3 control) {
    const Vec3& acce = ahead_.state.acce[ahead_.row];
    for (int k = 0; k < kMostSteps; ++k) {
      if (is_straight(control)) return go_straight(control);
      for (int c = 0; c < 3; ++c) {
        const double change = acce[c] * dt_;
        if (c == 1 && kind_.car && kind_.car->mode == Steering::steer) {
          control[1] = clip(ahead_.extra[0], control[1] - change, control[1] + change);
          continue;
        }
        control[c] = control[c] > 0.0 ? std::max(0.0, control[c] - change) : std::min(0.0, control[c] + change);
        if (std::fabs(control[c]) < kStill) control[c] = 0.0;
      }
      if (stands(control)) return;
      step(control);
    }
    double left = 0.0;
    for (int c = 0; c < kind_.travel; ++c) left += std::fabs(stopping_way(control[c], acce[c] * dt_, dt_));
    out_.bulge += left + 2.0 * ahead_.reach;
  }

 private:
  /// Append a place; returns the way from the place before [m].
  double add(Vec2 shift, double angle, double time) {
    const Place& last = out_.places.back();
    const double turn = angle - last.angle, way = norm(shift - last.shift);
    const double travel = way * (1.0 + kArc * turn * turn) + ahead_.reach * std::fabs(turn);
    out_.travel += travel;
    out_.places.push_back({shift, angle, turn != 0.0 ? unit(angle) : last.turn, time, travel});
    return way;
  }

  bool stands(const Vec3& control) const {
    for (int c = 0; c < kind_.travel; ++c) {
      if (control[c] != 0.0) return false;
    }
    return kind_.yaw < 0 || control[kind_.yaw] == 0.0;
  }

  /// Whether the rest of a stop leads straight on, so that its end alone counts.
  bool is_straight(const Vec3& control) const {
    if (kind_.yaw >= 0 && control[kind_.yaw] != 0.0) return false;
    if (kind_.car) {
      const double to = kind_.car->mode == Steering::steer ? control[1] : ahead_.extra[0];
      return ahead_.extra[0] == 0.0 && to == 0.0 && (kind_.car->mode == Steering::steer || control[1] == 0.0);
    }
    return kind_.travel < 2 || control[0] == 0.0 || control[1] == 0.0;
  }

  void go_straight(const Vec3& control) {
    const Vec3& acce = ahead_.state.acce[ahead_.row];
    Vec2 way{stopping_way(control[0], acce[0] * dt_, dt_), 0.0};
    if (kind_.travel > 1) way.y = stopping_way(control[1], acce[1] * dt_, dt_);
    if (way.x != 0.0 || way.y != 0.0)
      add(pose_.position() - from_.position() + rotate(way, heading_), turned_, steps_ + 1.0);
  }

  const Ahead& ahead_;
  const Drive& drive_;
  const Components kind_;
  const Pose from_;
  Pose pose_;
  Vec2 heading_, start_;
  double dt_, turned_ = 0.0;
  int steps_ = 0;
  Manoeuvre& out_;
};

/// Largest magnitude that a component of the control can have in the next step.
double most(const Ahead& ahead, int c) {
  const double now = ahead.state.control[ahead.row][c], change = ahead.state.acce[ahead.row][c] * ahead.world.step_time;
  return std::max(std::fabs(std::max(ahead.state.vel_min[ahead.row][c], now - change)),
                  std::fabs(std::min(ahead.state.vel_max[ahead.row][c], now + change)));
}

/// Largest distance that a component of a control leads to in its step and the stop after it.
double way_with(const Ahead& ahead, int c) {
  const double speed = most(ahead, c), change = ahead.state.acce[ahead.row][c] * ahead.world.step_time;
  return speed * ahead.world.step_time + std::fabs(stopping_way(speed, change, ahead.world.step_time));
}

double car_turn(const Car& car, double way) {
  return way * std::tan(std::min(car.psi_max, kSteep)) / (car.wheelbase > 0.0 ? car.wheelbase : 1.0);
}

}  // namespace

Vec3 Ahead::limited(Vec3 wanted) const {
  const Vec3& now = state.control[row];
  Vec3 next;
  for (int c = 0; c < 3; ++c) {
    const double change = state.acce[row][c] * world.step_time;
    next[c] = clip(wanted[c], std::max(state.vel_min[row][c], now[c] - change),
                   std::min(state.vel_max[row][c], now[c] + change));
  }
  with(world.drive[object], [&](const auto& drive) { next = constrain(drive, next); });
  return next;
}

Vec3 Ahead::braking() const {
  const bool car = steers(world.drive[object]);
  return braking_control(world.drive[object],
                         car ? state.extra[static_cast<std::size_t>(row) * state.extra_rows] : 0.0);
}

void Ahead::step_and_stop(Vec3 control, Manoeuvre& out) const {
  Run run(*this, out);
  run.step(control);
  run.stop(control);
}

void Ahead::stop(Manoeuvre& out) const { Run(*this, out).stop(state.control[row]); }

double Ahead::range() const {
  const Components kind = components_of(world.drive[object]);
  if (kind.travel == 0) return length(most(*this, 0), most(*this, 1)) * world.step_time + reach;
  const double way = length(way_with(*this, 0), kind.travel > 1 ? way_with(*this, 1) : 0.0);
  double turn = kind.yaw < 0 ? 0.0 : way_with(*this, kind.yaw);
  if (kind.car) turn = car_turn(*kind.car, way);
  return way + reach * std::min(turn, 2.0);
}

double Ahead::play() const {
  const Components kind = components_of(world.drive[object]);
  if (kind.car || kind.travel == 0) return range();
  const double dt = world.step_time;
  const auto gap = [&](int c) {
    const double change = state.acce[row][c] * dt, now = std::fabs(state.control[row][c]);
    return std::isfinite(change) ? dt * (most(*this, c) + now + change) : most(*this, c) * dt;
  };
  const auto whole = [&](int c) { return way_with(*this, c); };
  double way = gap(0), far = whole(0), turn = 0.0;
  if (kind.travel > 1) way = length(way, gap(1)), far = length(far, whole(1));
  if (kind.yaw >= 0) turn = gap(kind.yaw);
  return std::min(range(), way + (far + reach) * turn);
}

bool glides(const World& world, const State& state, int row, int object) {
  bool found = false;
  with(world.drive[object], [&](const auto& drive) {
    const Rows kind = rows(drive);
    for (int c = 0; c < kind.travel; ++c) found = found || std::isfinite(state.acce[row][c]);
    found = found || (kind.yaw >= 0 && std::isfinite(state.acce[row][kind.yaw]));
  });
  return found;
}

}  // namespace irsim
