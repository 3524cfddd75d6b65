// Differential drive with mass and motors: forward speed and yaw rate are wanted, torques of the wheels bring them
// about.
#pragma once

#include "drive.hpp"
#include "fields.hpp"

namespace irsim {

struct DiffDynamicOptions {
  bool noise;
  std::array<double, 4> alpha;
  double mass;             // with wheels and rotors [kg]
  double inertia;          // about the vertical axis through the middle of the axle [kg m^2]
  double wheel_radius;     // [m]
  double track;            // distance of the wheels [m]
  double drag;             // force per speed [N s/m]
  double turn_drag;        // torque per yaw rate [N m s]
  double torque_max;       // of a wheel [N m], may be infinite
  double voltage;          // largest of a motor [V], may be infinite
  double resistance;       // of a motor [ohm]
  double torque_constant;  // of a motor [N m/A] and [V s/rad]
  double gear;             // turns of the motor per turn of the wheel
  double response;         // time constant of the controller of speeds [s]
  double friction;         // coefficient of the wheels, may be infinite: they hold every force
  double slip_stiffness;   // force = friction * load * tanh(stiffness * slip), may be infinite: no slip under force
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using O = DiffDynamicOptions;
    return visit(
        field("noise", &O::noise), field("alpha", &O::alpha), field("mass", &O::mass), field("inertia", &O::inertia),
        field("wheel_radius", &O::wheel_radius), field("track", &O::track), field("drag", &O::drag),
        field("turn_drag", &O::turn_drag), field("torque_max", &O::torque_max), field("voltage", &O::voltage),
        field("resistance", &O::resistance), field("torque_constant", &O::torque_constant), field("gear", &O::gear),
        field("response", &O::response), field("friction", &O::friction), field("slip_stiffness", &O::slip_stiffness));
  }

  /// The largest torque of a wheel that the ground bears [N m]. Without a coefficient of the wheels, the grip is one.
  double borne(const Footing* footing, int wheel) const {
    constexpr double kGravity = 9.81;  // [m/s^2]
    const double grip = footing == nullptr ? 1.0 : footing[wheel].grip;
    const double coefficient = std::isfinite(friction) || grip == 1.0 ? friction * grip : grip;
    return 0.5 * coefficient * mass * kGravity * wheel_radius;
  }

  /// The torque that a wheel gets of a wanted one while it turns at a rate [N m].
  double possible(double wanted, double rate, double most) const {
    const double back = torque_constant * gear * rate, scale = torque_constant * gear / resistance;
    const double low = scale * (-voltage - back), high = scale * (voltage - back);
    return clip(clip(wanted, low, high), -most, most);
  }
};

/// Torques of the left and the right wheel [N m], with which the controller would bring both speeds to their wanted
/// values exponentially.
///
/// Args:
///   most: The largest of each.
inline std::array<double, 2> torques(const DiffDynamicOptions& o, Vec2 speeds, Vec3 control,
                                     const std::array<double, 2>& most) {
  const double v = speeds.x, w = speeds.y, half = 0.5 * o.track;
  const double force = o.mass * (control[0] - v) / o.response + o.drag * v;
  const double moment = o.inertia * (control[1] - w) / o.response + o.turn_drag * w;
  const double both = 0.5 * force * o.wheel_radius, apart = 0.5 * moment * o.wheel_radius / half;
  return {{o.possible(both - apart, (v - half * w) / o.wheel_radius, most[0]),
           o.possible(both + apart, (v + half * w) / o.wheel_radius, most[1])}};
}

/// Changes of forward speed and yaw rate [m/s^2], [rad/s^2]: mass * v' = sum of torques / radius - drag * v, and the
/// same of the turn.
inline Vec2 acceleration(const DiffDynamicOptions& o, Vec2 speeds, Vec3 control, const std::array<double, 2>& most) {
  const auto [left, right] = torques(o, speeds, control, most);
  return {((left + right) / o.wheel_radius - o.drag * speeds.x) / o.mass,
          ((right - left) * 0.5 * o.track / o.wheel_radius - o.turn_drag * speeds.y) / o.inertia};
}

/// The speed at which a wheel turns that drives or brakes with a torque: faster or slower than it rolls, by the slip
/// at which the ground bears this torque.
inline double turning(const DiffDynamicOptions& o, double rolling, double torque, double borne) {
  constexpr double kSpinning = 0.95;  // largest slip
  if (!std::isfinite(o.slip_stiffness) || !std::isfinite(borne)) return rolling;
  const double slip = std::min(kSpinning, std::atanh(std::min(1.0, std::fabs(torque) / borne)) / o.slip_stiffness);
  return torque * rolling > 0.0 ? rolling / (1.0 - slip) : rolling * (1.0 - slip);
}

/// Wheels roll without slip, except where zones say otherwise. The motion is integrated in parts by the classical
/// fourth-order Runge-Kutta method, whatever the integration. The extra rows are the rates of the left and the right
/// wheel [rad/s].
inline void diff_dynamic(const DiffDynamicOptions& o, const Motion& m) {
  constexpr double kLargest = 0.01, kMostParts = 10000.0;  // largest part [s]
  double &left = m.extra[0], &right = m.extra[1];
  const double half = 0.5 * o.track;
  Vec2 speeds{0.5 * o.wheel_radius * (left + right), 0.5 * o.wheel_radius * (right - left) / half};
  if (!(m.dt > 0.0)) {
    const Vec2 ground = over_ground(speeds, half, m.footing), v = m.direction * ground.x;
    m.twist = {{v.x, v.y, ground.y}};
    return;
  }
  // Parts are short against every time constant.
  const double motor = o.torque_constant * o.gear / o.wheel_radius, braking = 2.0 * motor * motor / o.resistance;
  const double fast =
      std::max({1.0 / o.response, (braking + o.drag) / o.mass, (braking * half * half + o.turn_drag) / o.inertia});
  const int parts = static_cast<int>(clip(std::ceil(m.dt * std::max(1.0 / kLargest, fast) - 1e-9), 1.0, kMostParts));
  const double dt = m.dt / parts;
  const Pose before = m.pose;
  const std::array<double, 2> borne = {{o.borne(m.footing, 0), o.borne(m.footing, 1)}};
  const std::array<double, 2> most = {{std::min(o.torque_max, borne[0]), std::min(o.torque_max, borne[1])}};
  double turned = 0.0;
  Vec2 way;
  for (int k = 0; k < parts; ++k) {
    const Vec2 a = acceleration(o, speeds, m.control, most);
    const Vec2 b = acceleration(o, speeds + a * (0.5 * dt), m.control, most);
    const Vec2 c = acceleration(o, speeds + b * (0.5 * dt), m.control, most);
    const Vec2 d = acceleration(o, speeds + c * dt, m.control, most);
    const Vec2 next = speeds + (a + b * 2.0 + c * 2.0 + d) * (dt / 6.0);
    const Vec2 middle = (speeds + next) * 0.5 + (a - d) * (dt / 8.0);
    // Simpson's rule, for the turn and for the way, whose direction turns, too.
    const Vec2 first = over_ground(speeds, half, m.footing), second = over_ground(middle, half, m.footing),
               third = over_ground(next, half, m.footing);
    const double half_turn = dt / 24.0 * (5.0 * first.y + 8.0 * second.y - third.y);
    const double turn = dt / 6.0 * (first.y + 4.0 * second.y + third.y);
    way = way + (unit(turned) * first.x + unit(turned + half_turn) * (4.0 * second.x) + unit(turned + turn) * third.x) *
                    (dt / 6.0);
    turned += turn;
    const Vec2 wheels = (speeds + middle * 4.0 + next) * (1.0 / 6.0), body = over_ground(wheels, half, m.footing);
    const auto pull = torques(o, middle, m.control, most);
    const double turning_left = turning(o, wheels.x - half * wheels.y, pull[0], borne[0]);
    const double turning_right = turning(o, wheels.x + half * wheels.y, pull[1], borne[1]);
    add_unmoved(m, {0.5 * (turning_left + turning_right), 0.0}, 0.5 * (turning_right - turning_left) / half,
                {body.x, 0.0}, body.y, dt);
    speeds = next;
  }
  const Vec2 moved = rotate(way, m.direction);
  m.pose.x += moved.x, m.pose.y += moved.y;
  m.pose.theta = wrap(before.theta + turned);
  left = (speeds.x - half * speeds.y) / o.wheel_radius, right = (speeds.x + half * speeds.y) / o.wheel_radius;
  set_mean_twist(m, before, turned);
}

inline std::array<Vec2, 2> wheels(const DiffDynamicOptions& o) { return side_by_side(o.track); }

inline Rows rows(const DiffDynamicOptions& o) { return {1, 1, 2, true, std::isfinite(o.slip_stiffness)}; }

inline Vec3 deviation(const DiffDynamicOptions& o, Vec3 control) { return velocity_deviation(o.alpha, control); }

inline Vec3 follow(const DiffDynamicOptions&, const Wish& wish) {
  const ForwardWish forward = forward_wish(wish);
  return {{forward.speed, turn_rate(forward.error, wish.turning), 0.0}};
}

inline void rest(const DiffDynamicOptions&, double* extra) { extra[0] = extra[1] = 0.0; }

}  // namespace irsim
