// The effect of the ground on a wheel.
#pragma once

#include <array>

#include "geometry/vec.hpp"

namespace irsim {

/// The ground under one wheel, or under one side of a drive with tracks.
struct Footing {
  double slip = 0.0;      // share of the wheel's way that the body does not move, 0 to 1
  double grip = 1.0;      // factor on the friction of the wheel
  double spread = 0.0;    // track of skid steering as it turns, over the distance of its sides; 0: as the drive says
  double traction = 1.0;  // speed over ground per speed of a side of skid steering, where `spread` is given
};

/// The ground under the wheels of a row from step to step.
struct Underfoot {
  std::array<Footing, 2> wheel;                     // left and right, or front and rear, or the same twice
  std::array<double, 2> wander = {{kNone, kNone}};  // the slip of each wheel, in standard deviations from its mean
  Vec3 unmoved;  // way ahead and aside [m] and turn [rad] of this episode that wheels made and the body did not
};

/// Forward speed [m/s] and yaw rate [rad/s] over ground of a body on two wheels.
///
/// Args:
///   speeds: The same as if the wheels did not slip.
///   half: Half of the distance of the wheels [m].
///   footing: Of the left and the right wheel.
inline Vec2 over_ground(Vec2 speeds, double half, const Footing* footing) {
  if (footing == nullptr) return speeds;
  const double lost_left = footing[0].slip, lost_right = footing[1].slip;
  if (lost_left == lost_right) return lost_left == 0.0 ? speeds : speeds * (1.0 - lost_left);
  const double left = (speeds.x - half * speeds.y) * (1.0 - lost_left);
  const double right = (speeds.x + half * speeds.y) * (1.0 - lost_right);
  return {0.5 * (left + right), 0.5 * (right - left) / half};
}

}  // namespace irsim
