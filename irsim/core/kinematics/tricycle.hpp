// Tricycle with a steered and driven front wheel, reference point on the rear axle: speed of that wheel and steering
// angle (or steering rate).
#pragma once

#include "drive.hpp"
#include "fields.hpp"
#include "steering_gear.hpp"

namespace irsim {

struct TricycleOptions {
  bool noise;
  std::array<double, 4> alpha;
  Steering mode;      // steer: the second control is the steering angle; angular: its rate
  double wheelbase;   // [m]
  double psi_max;     // largest steering angle [rad], at most a quarter turn
  double steer_rate;  // [rad/s], may be infinite
  double steer_acce;  // [rad/s^2], may be infinite
  double steer_lag;   // [s]
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("noise", &TricycleOptions::noise), field("alpha", &TricycleOptions::alpha),
                 choice("mode", &TricycleOptions::mode, "steer", "angular"),
                 field("wheelbase", &TricycleOptions::wheelbase), field("psi_max", &TricycleOptions::psi_max),
                 field("steer_rate", &TricycleOptions::steer_rate), field("steer_acce", &TricycleOptions::steer_acce),
                 field("steer_lag", &TricycleOptions::steer_lag));
  }
};

inline SteeringGear gear_of(const TricycleOptions& options) {
  return {options.steer_rate, options.steer_acce, options.steer_lag};
}

/// The front wheel rolls where it points: v = v_f cos(psi), omega = v_f sin(psi) / wheelbase. At a quarter turn the
/// body turns about the middle of its rear axle.
inline void tricycle(const TricycleOptions& options, const Motion& m) {
  const double wheelbase = options.wheelbase > 0.0 ? options.wheelbase : 1.0, speed = m.control[0];
  const double kept = m.footing == nullptr ? 1.0 : 1.0 - m.footing->slip;
  const auto roll = [&](const Motion& part, double psi) {
    // The cosine of a quarter turn is a rounding error.
    const double ahead = std::fabs(psi) < 0.5 * kPi ? speed * std::cos(psi) : 0.0;
    const double turn = speed * std::sin(psi) / wheelbase;
    move(part, {ahead * kept, 0.0}, turn * kept);
    add_unmoved(m, {ahead, 0.0}, turn, {ahead * kept, 0.0}, turn * kept, part.dt);
  };
  const SteeringGear gear = gear_of(options);
  double &psi = m.extra[0], &rate = m.extra[1];
  const int parts = sub_steps(m.dt);
  if (gear.is_ideal() || m.integration == kEuler || !(m.dt > 0.0)) {
    roll(m, psi);
    for (int k = 0; k < parts; ++k)
      turn_wheels(gear, options.mode, m.control[1], options.psi_max, psi, rate, m.dt / parts);
    return;
  }
  const Pose before = m.pose;
  Vec2 direction = m.direction;
  double turn = 0.0;
  for (int k = 0; k < parts; ++k) {
    const double psi_before = psi, dt = m.dt / parts;
    turn_wheels(gear, options.mode, m.control[1], options.psi_max, psi, rate, dt);
    Vec3 twist;
    roll({m.pose, m.extra, twist, direction, m.control, dt, m.integration}, 0.5 * (psi_before + psi));
    turn += twist[2] * dt;
    direction = unit(m.pose.theta);
  }
  set_mean_twist(m, before, turn);
}

inline std::array<Vec2, 2> wheels(const TricycleOptions& options) {
  const Vec2 front{options.wheelbase > 0.0 ? options.wheelbase : 1.0, 0.0};
  return {{front, front}};
}

inline Rows rows(const TricycleOptions&) { return {1, -1, 2}; }

inline Vec3 deviation(const TricycleOptions& options, Vec3 control) {
  return velocity_deviation(options.alpha, control);
}

inline Vec3 constrain(const TricycleOptions& options, Vec3 control) {
  const double most = options.mode == Steering::steer ? options.psi_max : options.steer_rate;
  control[1] = clip(control[1], -most, most);
  return control;
}

inline std::optional<Car> steering(const TricycleOptions& options) {
  // Wheels that turn during the period are about half-way on the average.
  const double acts = gear_of(options).is_ideal() ? 0.0 : 0.5;
  return Car{options.mode, options.wheelbase, options.psi_max, acts, true};
}

/// Point the wheel in the wanted direction; it drives slowly until it does.
inline Vec3 follow(const TricycleOptions& options, const Wish& wish) {
  constexpr double kMinRolling = 0.2;  // smallest share of the wanted speed
  const ForwardWish forward = forward_wish(wish);
  const double speed = norm(wish.velocity), now = wish.extra[0];
  if (!(speed > wish.turning.min_speed)) return {};
  const double psi = clip(forward.error, -options.psi_max, options.psi_max);
  const double ahead = std::max(std::cos(psi), std::cos(now));  // share of the wheel's speed that the body drives ahead
  double rolling = speed * std::max(kMinRolling, std::cos(psi - now));
  if (rolling * ahead > wish.turning.max_forward) rolling = std::max(0.0, wish.turning.max_forward) / ahead;
  if (options.mode == Steering::steer) return {{rolling, psi, 0.0}};
  return {{rolling, turn_rate(psi - now, wish.turning), 0.0}};
}

}  // namespace irsim
