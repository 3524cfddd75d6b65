// Ackermann steering, reference point on the rear axle: forward speed and steering angle (or steering rate).
#pragma once

#include "drive.hpp"
#include "fields.hpp"

namespace irsim {

struct AckerOptions {
  bool noise;
  std::array<double, 4> alpha;
  Steering mode;     // steer: the second control is the steering angle; angular: its rate
  double wheelbase;  // [m]
  double psi_max;    // largest steering angle [rad], may be infinite
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("noise", &AckerOptions::noise), field("alpha", &AckerOptions::alpha),
                 choice("mode", &AckerOptions::mode, "steer", "angular"), field("wheelbase", &AckerOptions::wheelbase),
                 field("psi_max", &AckerOptions::psi_max));
  }
};

inline void acker(const AckerOptions& options, const Motion& m) {
  const double wheelbase = options.wheelbase > 0.0 ? options.wheelbase : 1.0;
  const double slope = std::tan(m.extra[0]);
  const double speed = m.footing == nullptr ? m.control[0] : m.control[0] * (1.0 - m.footing->slip);
  move_on_ground(m, {m.control[0], 0.0}, m.control[0] * slope / wheelbase, {speed, 0.0}, speed * slope / wheelbase);
  // The wheels turn at the end of the period, whatever the integration.
  const double psi = options.mode == Steering::steer ? m.control[1] : m.extra[0] + m.control[1] * m.dt;
  m.extra[0] = clip(psi, -options.psi_max, options.psi_max);
}

inline Rows rows(const AckerOptions&) { return {1, -1, 1}; }

inline Vec3 deviation(const AckerOptions& options, Vec3 control) { return velocity_deviation(options.alpha, control); }

inline Vec3 constrain(const AckerOptions& options, Vec3 control) {
  if (options.mode == Steering::steer) control[1] = clip(control[1], -options.psi_max, options.psi_max);
  return control;
}

inline std::optional<Car> steering(const AckerOptions& options) {
  return Car{options.mode, options.wheelbase, options.psi_max, 0.0, false};
}

/// Steer straight toward the wanted direction; in mode `angular` the wheels turn there at a limited rate. A car turns
/// only while it rolls, so it creeps where other drives would turn on the spot.
inline Vec3 follow(const AckerOptions& options, const Wish& wish) {
  constexpr double kMinRolling = 0.2;  // smallest share of the wanted speed
  ForwardWish forward = forward_wish(wish);
  if (forward.error != 0.0)
    forward.speed = std::max(forward.speed, std::min(kMinRolling * norm(wish.velocity), wish.turning.max_forward));
  if (options.mode == Steering::steer) return {{forward.speed, forward.error, 0.0}};
  const double psi = clip(forward.error, -0.25 * kPi, 0.25 * kPi);
  return {{forward.speed, turn_rate(psi - wish.extra[0], wish.turning), 0.0}};
}

}  // namespace irsim
