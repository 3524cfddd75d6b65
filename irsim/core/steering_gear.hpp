// How steered wheels turn.
#pragma once

#include "drive.hpp"

namespace irsim {

constexpr double kSubStep = 0.01;  // longest step of what is integrated in several [s]

/// Number of equal steps of at most `kSubStep` in a period.
inline int sub_steps(double dt) { return std::max(1, static_cast<int>(std::ceil(dt / kSubStep - 1e-9))); }

/// How fast steered wheels turn.
struct SteeringGear {
  double rate;  // largest rate of the angle [rad/s], may be infinite
  double acce;  // largest change of that rate [rad/s^2], may be infinite
  double lag;   // time constant of the angle, or in mode `angular` of its rate [s]

  bool is_ideal() const { return !std::isfinite(rate) && !std::isfinite(acce) && !(lag > 0.0); }

  /// Way of the angle towards one that is `left` away: at the largest rate until the lag alone is slower, then with the
  /// lag [rad].
  double way(double left, double dt) const {
    const double fast = std::max(0.0, left / rate - lag), first = std::min(fast, dt);
    const double way = first > 0.0 ? rate * first : 0.0;
    if (!(dt > fast)) return way;
    return way + (left - way) * (lag > 0.0 ? 1.0 - std::exp((fast - dt) / lag) : 1.0);
  }
};

/// Let steered wheels turn for a time. Without a limit of their acceleration the result is exact for any time.
///
/// Args:
///   wanted: Steering angle [rad], or its rate [rad/s].
///   most: Largest steering angle [rad].
///   psi, rate: Steering angle [rad] and its rate [rad/s], which are advanced.
inline void turn_wheels(const SteeringGear& gear, Steering mode, double wanted, double most, double& psi, double& rate,
                        double dt) {
  if (!(dt > 0.0)) return;
  const double change = gear.acce * dt, before = rate;
  double way;
  if (mode == Steering::angular) {
    const double target = clip(wanted, -gear.rate, gear.rate);
    const double kept = gear.lag > 0.0 ? std::exp(-dt / gear.lag) : 0.0;
    rate = clip(target + (before - target) * kept, before - change, before + change);
    const bool free = rate == target + (before - target) * kept;
    way = free ? target * dt + (before - target) * gear.lag * (1.0 - kept) : 0.5 * (before + rate) * dt;
  } else {
    const double error = clip(wanted, -most, most) - psi, left = std::fabs(error);
    const double asked = std::min(gear.way(left, dt), dt * speed_to_stop_within(left, gear.acce, dt));
    way = dt * clip(std::copysign(asked, error) / dt, before - change, before + change);
    rate = way / dt;
  }
  const double next = psi + way;
  psi = clip(next, -most, most);
  if (psi != next) rate = 0.0;
}

}  // namespace irsim
