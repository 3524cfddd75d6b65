// The interface of drives. Each header in kinematics/ defines these functions for one options struct, by overload.
//
//   void    NAME(options, motion)        one period of motion (the function is named like the file)
//   Vec3    deviation(options, control)  standard deviations of the motion noise
//   Vec3    follow(options, wish)        controls that realise a wanted world-frame velocity
//   Rows    rows(options)                which controls are what
//   Vec3    constrain(options, control)  limits beyond vel_min, vel_max and acce (optional)
//   void    rest(options, extra)         forget inner speeds, when something else has stopped the body (optional)
//   array   wheels(options)              body-frame places of its two wheels, where the ground matters (optional)
//   Car     steering(options)            how it steers, of a drive whose second control steers wheels (optional)
//
// The struct has `bool noise`. A field `wheelbase` receives the wheelbase of the drive, else of the shape, else 1.
// `dash` calls `follow` with the top speed toward the goal, unless behaviors/dash.hpp has a law for the drive. Planned
// paths, `orca` and `footprint_orca` go by `rows` and `steering`: what steers is driven as a car, what has one travel
// row and a yaw rate as a drive that turns on the spot.
#pragma once

#include <optional>

#include "footing.hpp"
#include "geometry/vec.hpp"
#include "integration.hpp"
#include "steering.hpp"

namespace irsim {

/// One object during one period: pose and extra rows are advanced in place, twist is written.
struct Motion {
  Pose& pose;      // x, y [m], theta [rad]; world frame
  double* extra;   // extra state rows, steering angle first
  Vec3& twist;     // true vx, vy [m/s] at the start of this period and yaw rate [rad/s]; world frame
  Vec2 direction;  // cosine and sine of the heading at the start
  Vec3 control;    // executed control, noise included
  double dt;       // [s]
  Integration integration;
  const Footing* footing = nullptr;  // (2,) of its wheels; null: they do not slip
  Vec3* unmoved = nullptr;  // receives the way ahead and aside [m] and the turn [rad] that wheels make and the body not
};

/// How sharply a drive that cannot move sideways turns toward a wanted velocity.
struct Turning {
  double min_speed = 0.02;         // wanted velocities below this speed count as a stop [m/s]
  double tolerance = 0.1;          // smaller heading errors are not corrected [rad]
  double guarantee_time = 0.2;     // time in which a heading error is to be removed [s]
  double max_rate = 1.5;           // largest turn rate [rad/s]
  double max_forward = kInfinity;  // largest speed along the present heading [m/s]
  double acce = kInfinity;         // largest change of the turn rate [rad/s^2]
  double dt = 0.0;                 // period, which counts if `acce` is finite [s]
};

/// A wanted world-frame velocity [m/s] and what a drive needs to know to realise it.
struct Wish {
  Vec2 velocity;
  const Pose& pose;
  const double* extra;
  Vec2 direction;  // cosine and sine of the heading
  Turning turning;
};

/// The largest speed with which an object may move on for one period, so that it then stops within what is left without
/// going beyond it: its speed changes by at most `acce * dt` per period. Infinite without such a limit.
///
/// With v = (n + f) * acce * dt, n whole and 0 <= f < 1, this period and the n after it, each slower by `acce * dt`,
/// take the object (n + 1) * (n / 2 + f) * acce * dt^2 far. So an object that asks for this speed in every period never
/// gets beyond its mark, unless it is too fast for that already.
///
/// Args:
///   left: Distance to the mark, at least 0 [m], or [rad] of a turn.
///   acce: Largest change of the speed [m/s^2] or [rad/s^2]; 0 counts as no limit.
///   dt: Period [s].
inline double speed_to_stop_within(double left, double acce, double dt) {
  if (!(acce > 0.0) || !std::isfinite(acce) || !std::isfinite(left)) return kInfinity;
  const double change = acce * dt, n = std::floor(-0.5 + std::sqrt(0.25 + 2.0 * left / (change * dt)));
  return left / (dt * (n + 1.0)) + 0.5 * n * change;
}

/// The meaning of the components of a control.
struct Rows {
  int travel;     // number of leading components that are translation: forward, then lateral speed
  int yaw;        // index of the component that is a yaw rate, -1 without one: contacts then change the speed only
  int inner = 0;  // number of extra state rows that the drive uses
  bool coasts = false;  // whether speeds are among these rows, so that they need time to change
  bool slides = false;  // whether wheels turn otherwise than the body moves on every ground
};

template <class Options>
Vec3 constrain(const Options&, Vec3 control) {
  return control;
}

template <class Options>
void rest(const Options&, double*) {}

template <class Options>
std::array<Vec2, 2> wheels(const Options&) {
  return {};
}

/// Body-frame places of a left and a right wheel at this distance of each other [m].
inline std::array<Vec2, 2> side_by_side(double track) { return {{{0.0, 0.5 * track}, {0.0, -0.5 * track}}}; }

template <class Options>
std::optional<Car> steering(const Options&) {
  return std::nullopt;
}

/// Translate by a body-frame velocity while turning at a yaw rate, both constant within the period, and write the
/// twist.
inline void translate(const Motion& m, Vec2 body_velocity, double yaw_rate) {
  const Vec2 v = rotate(body_velocity, m.direction), way = displacement(v, yaw_rate, m.dt, m.integration);
  m.pose.x += way.x;
  m.pose.y += way.y;
  m.twist = {{v.x, v.y, yaw_rate}};
}

/// Translate and turn.
inline void move(const Motion& m, Vec2 body_velocity, double yaw_rate) {
  translate(m, body_velocity, yaw_rate);
  m.pose.theta = wrap(m.pose.theta + yaw_rate * m.dt);
}

/// Add to what wheels turn and the body does not move.
///
/// Args:
///   wheels, wheel_turn: Velocity in the body frame and yaw rate that the turns of the wheels alone would give.
///   body, body_turn: The true ones.
///   time: For which they hold [s].
inline void add_unmoved(const Motion& m, Vec2 wheels, double wheel_turn, Vec2 body, double body_turn, double time) {
  if (m.unmoved == nullptr) return;
  Vec3& sum = *m.unmoved;
  sum[0] += (wheels.x - body.x) * time, sum[1] += (wheels.y - body.y) * time, sum[2] += (wheel_turn - body_turn) * time;
}

/// Translate and turn as `move` does, on wheels of which some slip.
inline void move_on_ground(const Motion& m, Vec2 wheels, double wheel_turn, Vec2 body, double body_turn) {
  move(m, body, body_turn);
  add_unmoved(m, wheels, wheel_turn, body, body_turn, m.dt);
}

/// Write the twist of a drive whose velocity changes within the period: of the arc, or under Euler of the straight way,
/// from the pose before to the pose now. A period of length 0 leaves the twist as it is.
///
/// Args:
///   turn: Change of the heading [rad], not wrapped.
inline void set_mean_twist(const Motion& m, const Pose& before, double turn) {
  if (!(m.dt > 0.0)) return;
  const Vec2 way = m.pose.position() - before.position();
  const double chord = sinc(0.5 * turn), half = m.integration == kExact && chord > 0.1 ? 0.5 * turn : 0.0;
  const Vec2 v = rotate(way, unit(-half)) * (1.0 / (m.dt * sinc(half)));
  m.twist = {{v.x, v.y, turn / m.dt}};
}

/// Standard deviations of forward speed and yaw (or steering) rate, which grow with both (Thrun, Burgard, Fox
/// 2005, 5.3).
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

/// The turn rate that removes a heading error in `guarantee_time`, capped, from which the turn can stop at the wanted
/// heading.
inline double turn_rate(double error, const Turning& turning) {
  const double most = std::min(turning.max_rate, speed_to_stop_within(std::fabs(error), turning.acce, turning.dt));
  return clip(error / turning.guarantee_time, -most, most);
}

}  // namespace irsim
