// How a body that keeps its velocity in its own frame moves within a period.
#pragma once

#include "geometry/vec.hpp"

namespace irsim {

/// How drives are integrated over a period.
enum Integration {
  kEuler = 0,  // along the heading at the start, then the turn, as IR-SIM 2.12 does
  kExact = 1,  // along the arc that a constant body-frame velocity and yaw rate describe
};

/// sin(x) / x, without division by numbers near zero.
inline double sinc(double x) {
  constexpr double kSeries = 5e-3;  // below it the next term of the series is less than 1e-17
  const double square = x * x;
  return std::fabs(x) < kSeries ? 1.0 - square / 6.0 * (1.0 - square / 20.0) : std::sin(x) / x;
}

/// Displacement [m] of a body after some time, world frame.
///
/// The arc is computed as its chord, which has the direction of the heading in the middle and is shorter than the path
/// by sinc(half the turn): no difference of nearly equal numbers occurs, and at yaw rate 0 both integrations agree to
/// the bit.
///
/// Args:
///   velocity: At the start [m/s], world frame; constant in the body frame.
///   yaw_rate: [rad/s].
///   time: [s].
inline Vec2 displacement(Vec2 velocity, double yaw_rate, double time, Integration integration) {
  if (integration == kEuler || yaw_rate == 0.0) return velocity * time;
  const double half = 0.5 * yaw_rate * time;
  return rotate(velocity, unit(half)) * (sinc(half) * time);
}

/// Pose of a body `time` seconds after the start of a period: on the arc of its twist, or, under Euler, on the straight
/// chord with a heading that turns linearly. After the whole period it is the pose to which its drive moves it, except
/// that the heading is not wrapped.
///
/// Args:
///   before: Pose at the start of the period.
///   twist: vx, vy [m/s] at the start, world frame, and yaw rate [rad/s], as in `State::twist`.
inline Pose pose_at(const Pose& before, const Vec3& twist, double time, Integration integration) {
  const Vec2 way = displacement({twist[0], twist[1]}, twist[2], time, integration);
  return {before.x + way.x, before.y + way.y, before.theta + twist[2] * time};
}

}  // namespace irsim
