// Steering to the next corner, and commands that keep clear of static objects.
#include "routes/follower.hpp"

#include "braking/stops.hpp"
#include "collision/touch.hpp"
#include "integration.hpp"
#include "routes/sides.hpp"
#include "world/features.hpp"

namespace irsim {
namespace {

constexpr int kBackingSteps = 8;        // steps that a manoeuvre of backing up lasts
constexpr double kGapShare = 0.9;       // share of a gap to a wall that is too small already which a command must keep
constexpr int kMaxBrakingSteps = 1000;  // number of steps of braking that are simulated ahead
constexpr int kHalvings = 6;            // of a step in which a corner of the object sweeps past something static

}  // namespace

void Follower::steer_to_corner(Vec3& u) {
  const Goal& target = state_.target[row_];
  const bool last = route_.next + 1 == route_.path.size();
  const Pose& pose = state_.pose[row_];
  const Vec2 way = target.position() - pose.position();
  if (last && norm(way) < world_.goal_threshold[object_]) return;
  const double error = wrap(std::atan2(way.y, way.x) - pose.theta);
  const Vec3 &top = state_.vel_max[row_], &acce = state_.acce[row_];
  const double left = norm(route_.path[route_.next] - pose.position());
  double most = kInfinity;
  if (!last) {
    most = left / world_.step_time;
    if (std::isfinite(acce[0]) && acce[0] > 0.0) most = std::min(most, std::sqrt(2.0 * acce[0] * left));
    most = std::max(most, 0.05);
  }
  with(world_.drive[object_], [&](const auto& drive) {
    if (is_diff(drive)) {
      const double rate = stopping_speed(std::fabs(error), 1, std::fabs(top[1]));
      u[1] = error > 0.0 ? rate : -rate;
      u[0] = std::fabs(error) > kMaxHeadingError ? 0.0 : std::min(u[0], most);
    } else if (rows(drive).travel == 2) {
      const double c = std::cos(error), s = std::sin(error);
      const double speed = std::min(
          {std::fabs(top[0]) / std::max(std::fabs(c), 1e-9), std::fabs(top[1]) / std::max(std::fabs(s), 1e-9), most});
      u[0] = speed * c, u[1] = speed * s;
    } else if (const std::optional<Car> car = steering(drive)) {
      const double most_psi = max_steering(*car), psi = clip(error, -most_psi, most_psi);
      const double now = state_.extra[static_cast<std::size_t>(row_) * state_.extra_rows];
      u[1] = car->mode == Steering::steer ? psi : (psi - now) / world_.step_time;
      u[0] = std::min(u[0], std::max(most, 0.3 * top[0]));
    }
  });
}

void Follower::slow_down_to_goal(Vec3& u) const {
  if (state_.goals[row_].left() > 1) return;
  int travel = 1;
  with(world_.drive[object_], [&](const auto& drive) { travel = rows(drive).travel; });
  double speed = 0.0, acce = kInfinity;
  for (int c = 0; c < travel; ++c) {
    speed = std::hypot(speed, u[c]);
    if (state_.acce[row_][c] > 0.0) acce = std::min(acce, state_.acce[row_][c]);
  }
  const double most = speed_to_stop_within(route_.way_ahead, acce, world_.step_time);
  if (!(speed > most)) return;
  for (int c = 0; c < travel; ++c) u[c] *= most / speed;
}

void Follower::back_off_from_goal() {
  const std::optional<Car> car = car_of(world_.drive[object_]);
  if (!car || route_.next + 1 < route_.path.size() || route_.backing_steps > 0) return;
  const Vec2 way = state_.goal[row_].position() - position();
  const double threshold = world_.goal_threshold[object_];
  if (norm(way) < threshold) return;
  const double radius = car->wheelbase / std::tan(max_steering(*car));
  const Vec2 point = unrotate(way, state_.heading(row_)), centre{0.0, point.y >= 0.0 ? radius : -radius};
  if (norm(point - centre) < radius - 0.5 * threshold) route_.backing_steps = kBackingSteps;
}

void Follower::keep_clear(Vec3& u) {
  if (std::holds_alternative<std::monostate>(world_.drive[object_]) || !clear_at(state_.pose[row_])) return;
  const bool car = steers(world_.drive[object_]);
  const int moving = std::holds_alternative<OmniOptions>(world_.drive[object_]) ||
                             std::holds_alternative<OmniAngularOptions>(world_.drive[object_])
                         ? 2
                         : 1;
  const auto scaled = [&](double share, double turn) {
    Vec3 v = u;
    for (int c = 0; c < 3; ++c) v[c] *= c < moving ? share : turn;
    return v;
  };
  const auto back = [&] {
    Vec3 v;
    v[0] = 0.4 * state_.vel_min[row_][0];
    if (car) v[1] = -u[1];
    return v;
  };
  if (route_.backing_steps > 0) {
    --route_.backing_steps;
    if (clear_after(back())) {
      u = back();
      return;
    }
    route_.backing_steps = 0;
  }
  for (const double share : {1.0, 0.5, 0.25, 0.1}) {
    if (!clear_after(scaled(share, 1.0))) continue;
    u = scaled(share, 1.0);
    return;
  }
  if (moving == 2) {  // pass it sideways first, then try without turning
    for (const double angle : {0.4, 0.8, 1.2}) {
      for (const double share : {1.0, 0.5, 0.25}) {
        for (const double sign : {1.0, -1.0}) {
          Vec3 v = scaled(share, 1.0);
          const Vec2 veered = rotate({v[0], v[1]}, unit(sign * angle));
          v[0] = veered.x, v[1] = veered.y;
          if (!clear_after(v)) continue;
          u = v;
          return;
        }
      }
    }
    for (const double share : {1.0, 0.5, 0.25, 0.1}) {
      if (!clear_after(scaled(share, 0.0))) continue;
      u = scaled(share, 0.0);
      return;
    }
  }
  const bool stands = norm({state_.control[row_][0], moving == 2 ? state_.control[row_][1] : 0.0}) < 0.02;
  if (!car && clear_after(scaled(0.0, 1.0))) {
    u = scaled(0.0, 1.0);
    return;
  }
  if (moving == 1 && stands && state_.vel_min[row_][0] < 0.0 && clear_after(back())) {
    route_.backing_steps = kBackingSteps;
    u = back();
    return;
  }
  u = scaled(0.0, car ? 1.0 : 0.0);
  if (car) hold_steering(u);
}

Vec3 Follower::braking() const { return ahead_of(object_).braking(); }

void Follower::hold_steering(Vec3& u) {
  const Vec3 held = braking();
  const double wanted = gap_;
  for (const double gap : {wanted, 0.0}) {  // the stop that was free a step ago may have kept a smaller gap
    gap_ = gap;
    const bool free = clear_after(u);
    if (!free && clear_after(held)) u = held;
    if (free || u[1] == held[1]) break;
  }
  gap_ = wanted;
}

void Follower::brake(Vec3& u) {
  u = glides_ ? braking() : Vec3{};
  if (steers(world_.drive[object_])) hold_steering(u);
}

void Follower::measure_gap() {
  const double wanted = route_.wall_margin;
  gap_ = 0.0;
  if (!(wanted > 0.0)) return;
  const double now = blockers_.gap(state_.scenes[w_].moving.footprint(shapes_, object_), wanted);
  gap_ = now < wanted ? std::max(0.0, kGapShare * now) : wanted;
}

Footprint Follower::body_at(const Pose& pose) {
  work_.ghost.resize(shapes_.size[0]);
  work_.ghost.place(shapes_, object_, pose, unit(pose.theta));
  return work_.ghost.footprint(shapes_, object_);
}

bool Follower::clear_at(const Pose& pose) {
  const Footprint body = body_at(pose);
  if (gap_ > 0.0 ? blockers_.gap(body, gap_) < gap_ : blockers_.meet(body)) return false;
  if (!glides_) {  // others see to their sides in `stays_on_sides`
    for (const Side& side : work_.sides) {
      if (support(body, side.normal) > side.offset) return false;
    }
  }
  for (const int other : route_.parked_seen) {  // a way round them may not exist
    if (is_parked(other) && touch(body, state_.scenes[w_].moving.footprint(shapes_, other))) return false;
  }
  if (route_.legs.empty()) return true;
  // An object cannot leave its legs, so it waits for moving objects that are in its way.
  return std::none_of(world_.moving.begin(), world_.moving.end(), [&](int i) {
    return i != object_ && !world_.unobstructed[i] && touch(body, state_.scenes[w_].moving.footprint(shapes_, i));
  });
}

bool Follower::clear_between(const Pose& pose, const Vec3& twist, double from, double to, int halvings) {
  const double way = norm({twist[0], twist[1]}) * (to - from), turn = std::fabs(twist[2]) * (to - from);
  const double travel = way + reach_ * turn;
  if (travel <= 2.0 * gap_ || halvings == 0) return true;
  const double middle = 0.5 * (from + to);
  const Pose there = pose_at(pose, twist, middle, world_.integration);
  const double room = blockers_.gap(body_at(there), 0.5 * travel);
  if (room >= 0.5 * travel) return true;
  return room > 0.0 && room >= gap_ && clear_between(pose, twist, from, middle, halvings - 1) &&
         clear_between(pose, twist, middle, to, halvings - 1);
}

bool Follower::clear_after(const Vec3& command) {
  if (glides_ && !stays_on_sides(command)) return false;
  const bool car = steers(world_.drive[object_]);
  Pose pose = state_.pose[row_];
  Vec3 control = state_.control[row_], wanted = command, twist;
  const double* extra = &state_.extra[static_cast<std::size_t>(row_) * state_.extra_rows];
  work_.extra.assign(extra, extra + state_.extra_rows);
  for (int k = 0; k < kMaxBrakingSteps; ++k) {
    bool moves = false;
    for (int c = 0; c < 3; ++c) {
      const double change = state_.acce[row_][c] * world_.step_time;
      control[c] = clip(wanted[c], std::max(state_.vel_min[row_][c], control[c] - change),
                        std::min(state_.vel_max[row_][c], control[c] + change));
      moves = moves || control[c] != 0.0;
    }
    if (k > 0 && !moves) return true;
    const Pose before = pose;
    with(world_.drive[object_], [&](const auto& drive) {
      control = constrain(drive, control);
      run(drive,
          Motion{pose, work_.extra.data(), twist, unit(pose.theta), control, world_.step_time, world_.integration});
    });
    if (!clear_at(pose)) return false;
    const bool sweeps = reach_ * std::fabs(twist[2]) * world_.step_time > gap_;  // a corner may cut another one
    if (sweeps && !clear_between(before, twist, 0.0, world_.step_time, kHalvings)) return false;
    wanted = car ? braking_control(world_.drive[object_], work_.extra[0]) : Vec3{};
    if (car && k > 0 && std::fabs(control[0]) < 1e-9) return true;
  }
  return true;
}
}  // namespace irsim
