// Drives that steer wheels, as behaviors see them.
#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/vec.hpp"

namespace irsim {

enum class Steering { steer, angular };

/// A drive whose second control is the angle of its wheels, or its rate. Its first extra row is the angle.
struct Car {
  Steering mode;     // steer: the second control is the steering angle; angular: its rate
  double wheelbase;  // [m]
  double psi_max;    // largest steering angle [rad], may be infinite
  double acts;       // share of a period in which a commanded angle already acts; 0: the wheels turn at its end
  bool front;        // whether the first control is the speed of the steered wheel instead of the fixed axle

  /// Yaw rate times wheelbase per speed at a steering angle [1].
  double yaw(double psi) const { return front ? std::sin(psi) : std::tan(psi); }
  /// The steering angle with that yaw rate [rad], at most a quarter turn.
  double angle_for(double yaw) const { return front ? std::asin(clip(yaw, -1.0, 1.0)) : std::atan(yaw); }
};

/// The largest angle to which behaviors steer the wheels. Where these turn at a limited rate and have no limit of their
/// own, that is 45 degrees: from larger angles they would come back too late.
inline double steering_range(const Car& car) {
  return car.mode == Steering::steer ? car.psi_max : std::min(car.psi_max, 0.25 * kPi);
}

}  // namespace irsim
