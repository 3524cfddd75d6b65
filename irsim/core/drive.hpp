// What every drive has to say about itself; each header in kinematics/ says it for one options struct, by overload.
//
//   void    NAME(options, motion)        one period of motion (the function is named like the file)
//   Vec3    deviation(options, control)  standard deviations of the motion noise
//   Vec3    follow(options, wish)        controls that realise a wanted world-frame velocity
//   Rows    rows(options)                which controls are what
//   Vec3    constrain(options, control)  limits beyond vel_min, vel_max and acce (optional)
#pragma once

#include "geometry/vec.hpp"

namespace irsim {

/// One object during one period: pose and extra rows are advanced in place, twist is written.
struct Motion {
  Pose& pose;      // x, y [m], theta [rad]; world frame
  double* extra;   // extra state rows, steering angle first
  Vec3& twist;     // true vx, vy [m/s] and yaw rate [rad/s] of this period; world frame
  Vec2 direction;  // cosine and sine of the heading at the start
  Vec3 control;    // executed control, noise included
  double dt;       // [s]
};

/// How sharply a drive that cannot move sideways turns toward a wanted velocity (reference: 5.4).
struct Turning {
  double min_speed = 0.02;         // slower wishes are a stop [m/s]
  double tolerance = 0.1;          // heading errors that are left alone [rad]
  double guarantee_time = 0.2;     // time in which an error should be gone [s]
  double max_rate = 1.5;           // [rad/s]
  double max_forward = kInfinity;  // no faster along the present heading [m/s]
};

/// A wanted world-frame velocity [m/s] and what a drive needs to know to realise it.
struct Wish {
  Vec2 velocity;
  const Pose& pose;
  const double* extra;
  Vec2 direction;  // cosine and sine of the heading
  Turning turning;
};

/// Which components of a control are what.
struct Rows {
  int travel;  // so many, the first, are translation: forward, then lateral speed
  int yaw;     // the one that is a yaw rate, -1 none
};

template <class Options>
Vec3 constrain(const Options&, Vec3 control) {
  return control;
}

/// Body-frame translation of a holonomic drive.
inline void translate(const Motion& m, Vec2 body_velocity) {
  const Vec2 v = rotate(body_velocity, m.direction);
  m.pose.x += v.x * m.dt;
  m.pose.y += v.y * m.dt;
  m.twist[0] = v.x, m.twist[1] = v.y;
}

/// Noise of a forward speed and a yaw (or steering) rate that grows with both (Thrun, Burgard, Fox 2005, 5.3).
template <class Alpha>
Vec3 velocity_deviation(const Alpha& alpha, Vec3 u) {
  const double v2 = u[0] * u[0], w2 = u[1] * u[1];
  return {{std::sqrt(alpha[0] * v2 + alpha[1] * w2), std::sqrt(alpha[2] * v2 + alpha[3] * w2), 0.0}};
}

/// Forward speed and heading error (positive: turn left) of a wanted velocity; a stop is {0, 0}.
struct ForwardWish {
  double speed, error;
};
inline ForwardWish forward_wish(const Wish& wish) {
  const double speed = norm(wish.velocity);
  if (!(speed > wish.turning.min_speed)) return {0.0, 0.0};
  const double error = -wrap(wish.pose.theta - std::atan2(wish.velocity.y, wish.velocity.x));
  const double ahead = std::min(std::max(0.0, speed * std::cos(error)), wish.turning.max_forward);
  return {ahead, std::fabs(error) < wish.turning.tolerance ? 0.0 : error};
}

/// The turn rate that removes a heading error in `guarantee_time`, capped.
inline double turn_rate(double error, const Turning& turning) {
  return clip(error / turning.guarantee_time, -turning.max_rate, turning.max_rate);
}

}  // namespace irsim
