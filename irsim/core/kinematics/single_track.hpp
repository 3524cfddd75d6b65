// Single track of a car: kinematic, or dynamic with tyres that slip. The equations are from CommonRoad: Althoff and
// Wuersching, "CommonRoad: Vehicle Models", 2020, models KS and ST.
#pragma once

#include <vector>

#include "drive.hpp"
#include "exponential.hpp"
#include "fields.hpp"
#include "steering_gear.hpp"

namespace irsim {

enum class SingleTrackModel { kinematic, dynamic };
enum class SingleTrackMode { steer, angular, acceleration };
enum class Tyres { saturating, linear };

struct SingleTrackOptions {
  bool noise;
  std::array<double, 4> alpha;
  SingleTrackModel model;
  Tyres tyres;                  // saturating: their force ends at friction times load; linear: as in CommonRoad
  SingleTrackMode mode;         // controls: speed and angle, speed and rate of the angle, acceleration and rate
  double wheelbase;             // [m]
  double psi_max;               // largest steering angle [rad]
  double steer_rate;            // largest rate of it [rad/s]
  double acce_max;              // largest acceleration along the way [m/s^2]
  double speed_switch;          // speed above which the engine's power limits the acceleration [m/s]
  double speed_min, speed_max;  // [m/s]
  double mass;                  // [kg]
  double inertia;               // about the vertical axis [kg m^2]
  double front, rear;           // distances of the axles from the centre of mass [m]
  double height;                // of the centre of mass [m]
  double friction;              // of tyres [1]
  double stiffness_front, stiffness_rear;  // of tyres [1/rad]
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using O = SingleTrackOptions;
    return visit(field("noise", &O::noise), field("alpha", &O::alpha),
                 choice("model", &O::model, "kinematic", "dynamic"), choice("tyres", &O::tyres, "saturating", "linear"),
                 choice("mode", &O::mode, "steer", "angular", "acceleration"), field("wheelbase", &O::wheelbase),
                 field("psi_max", &O::psi_max), field("steer_rate", &O::steer_rate), field("acce_max", &O::acce_max),
                 field("speed_switch", &O::speed_switch), field("speed_min", &O::speed_min),
                 field("speed_max", &O::speed_max), field("mass", &O::mass), field("inertia", &O::inertia),
                 field("front", &O::front), field("rear", &O::rear), field("height", &O::height),
                 field("friction", &O::friction), field("stiffness_front", &O::stiffness_front),
                 field("stiffness_rear", &O::stiffness_rear));
  }
};

/// Yaw rate [rad/s] and slip angle at the centre of mass [rad].
struct Lateral {
  double yaw, slip;
};

/// How these change: Lateral' = rates * Lateral + input.
struct LateralRates {
  Matrix2 rates;
  double input[2];
};

constexpr double kRolling = 0.5;   // up to this speed tyres do not slip, and backward never [m/s]
constexpr double kSpin = 0.5;      // from this slip angle on, angles are no longer small [rad]
constexpr double kSlipping = 1.0;  // from this speed on the dynamic model alone counts [m/s]

/// The effect of the ground on a car.
struct CarFooting {
  double kept = 1.0;               // speed over ground per speed of the wheels
  double front = 1.0, rear = 1.0;  // factors on the friction of the tyres

  /// Factor on the largest acceleration, which all wheels share.
  double pull() const { return std::min(1.0, 0.5 * (front + rear)); }
};

inline CarFooting car_footing(const Footing* footing) {
  if (footing == nullptr) return {};
  return {1.0 - footing[1].slip, footing[0].grip, footing[1].grip};
}

/// The acceleration that the engine, the brakes and the limits of speed leave of a wanted one [m/s^2].
inline double possible(const SingleTrackOptions& o, double speed, double wanted, double pull = 1.0) {
  if ((speed <= o.speed_min && wanted <= 0.0) || (speed >= o.speed_max && wanted >= 0.0)) return 0.0;
  const double most = o.acce_max * pull;
  return clip(wanted, -most, std::min(most, speed > o.speed_switch ? o.acce_max * o.speed_switch / speed : o.acce_max));
}

/// Yaw rate and slip angle of wheels that roll where they point.
inline Lateral rolling(const SingleTrackOptions& o, double speed, double psi) {
  const double length = o.front + o.rear, slope = std::tan(psi) / length, slip = std::atan(slope * o.rear);
  return {speed * std::cos(slip) * slope, slip};
}

/// The equations at a speed, a steering angle and an acceleration. An axle whose tyres slide at `now`, or that
/// spins, gives a constant force instead of one that grows with the slip.
inline LateralRates lateral_rates(const SingleTrackOptions& o, double speed, double psi, double acceleration,
                                  const Lateral& now, const CarFooting& ground = {}) {
  constexpr double kGravity = 9.81;  // [m/s^2]
  const double length = o.front + o.rear, arm = o.mass / o.inertia;
  const double ahead = speed * std::cos(now.slip), aside = speed * std::sin(now.slip);
  const auto axle = [&](double load, double stiffness, double place, double angle, double hold, LateralRates& out) {
    const double grip = o.friction * hold * std::max(0.0, load) / length, give = grip * stiffness;  // per mass [m/s^2]
    const double slide = angle - now.slip - place * now.yaw / speed;
    const bool slides =
        o.tyres == Tyres::saturating && (std::fabs(now.slip) > kSpin || std::fabs(slide) * stiffness > 1.0);
    double force = give * angle, lateral = force;
    if (slides) {
      force = clip(give * (angle - std::atan2(aside + place * now.yaw, std::fabs(ahead))), -grip, grip);
      lateral = force * std::cos(now.slip);
    }
    out.input[0] += arm * place * force, out.input[1] += lateral / speed;
    if (slides) return;
    out.rates.a -= arm * place * place * give / speed, out.rates.b -= arm * place * give;
    out.rates.c -= place * give / (speed * speed), out.rates.d -= give / speed;
  };
  LateralRates out{{0.0, 0.0, -1.0, 0.0}, {0.0, 0.0}};
  axle(kGravity * o.rear - acceleration * o.height, o.stiffness_front, o.front, psi, ground.front, out);
  axle(kGravity * o.front + acceleration * o.height, o.stiffness_rear, -o.rear, 0.0, ground.rear, out);
  return out;
}

/// One part of a period.
struct SingleTrackStep {
  double speed, psi;  // at its middle, over ground [m/s], [rad]
  double turn;        // [rad]
  double slip;        // at its middle [rad]
};

/// Share of the dynamic model at a speed, between 0 and 1.
inline double slipping(double speed) {
  const double share = clip((speed - kRolling) / (kSlipping - kRolling), 0.0, 1.0);
  return share * share * (3.0 - 2.0 * share);
}

inline Lateral blended(const SingleTrackOptions& o, double speed, double psi, const Lateral& tyres) {
  const double share = slipping(speed);
  if (share == 1.0) return tyres;
  const Lateral wheels = rolling(o, speed, psi);
  return {share * tyres.yaw + (1.0 - share) * wheels.yaw, share * tyres.slip + (1.0 - share) * wheels.slip};
}

/// Advance steering angle, speed, yaw rate and slip angle. The speed is the one of the wheels.
inline SingleTrackStep single_track_part(const SingleTrackOptions& o, Vec3 control, double* extra, double dt,
                                         const CarFooting& ground) {
  double &psi = extra[0], &rolled = extra[1];
  const double psi_before = psi, rolled_before = rolled;
  double rate = 0.0;
  const bool by_angle = o.mode == SingleTrackMode::steer;
  turn_wheels({o.steer_rate, kInfinity, 0.0}, by_angle ? Steering::steer : Steering::angular, control[1], o.psi_max,
              psi, rate, dt);
  const double wanted = o.mode == SingleTrackMode::acceleration ? control[0] : (control[0] - rolled) / dt;
  const double pull = ground.pull();
  const double acceleration = possible(o, rolled + 0.5 * dt * possible(o, rolled, wanted, pull), wanted, pull);
  rolled = o.mode == SingleTrackMode::acceleration
               ? clip(rolled + acceleration * dt, std::min(rolled, o.speed_min), std::max(rolled, o.speed_max))
               : rolled + acceleration * dt;
  const double speed = rolled * ground.kept, speed_before = rolled_before * ground.kept;
  SingleTrackStep step{0.5 * (speed_before + speed), 0.5 * (psi_before + psi), 0.0, 0.0};
  if (o.model == SingleTrackModel::kinematic) {
    step.turn = step.speed * std::tan(step.psi) / o.wheelbase * dt;
    extra[2] = speed * std::tan(psi) / o.wheelbase, extra[3] = 0.0;
    return step;
  }
  const Lateral before{extra[2], extra[3]};
  Lateral after = rolling(o, speed, psi);
  if (step.speed <= kRolling) {
    step.turn = rolling(o, step.speed, step.psi).yaw * dt;
    step.slip = rolling(o, step.speed, step.psi).slip;
  } else {
    const auto advanced = [&](Lateral from) {
      const LateralRates change = lateral_rates(o, step.speed, step.psi, (speed - speed_before) / dt, from, ground);
      double y[2] = {from.yaw, from.slip};
      advance_linear(change.rates, change.input, 0.5 * dt, y);
      return Lateral{y[0], y[1]};
    };
    const Lateral middle = advanced(before);
    after = advanced(middle);
    const Lateral one = blended(o, speed_before, psi_before, before), two = blended(o, step.speed, step.psi, middle),
                  three = blended(o, speed, psi, after);
    step.turn = dt / 6.0 * (one.yaw + 4.0 * two.yaw + three.yaw);
    step.slip = (one.slip + 4.0 * two.slip + three.slip) / 6.0;
    if (speed <= kRolling) after = rolling(o, speed, psi);
  }
  extra[2] = after.yaw, extra[3] = after.slip;
  return step;
}

/// The car is integrated in parts of at most 10 ms, whatever the integration: speed and wheels exactly, yaw rate and
/// slip angle exactly for the speed in the middle of the part. Tyres that slip are too stiff for larger steps at low
/// speed.
inline void single_track(const SingleTrackOptions& o, const Motion& m) {
  const bool dynamic = o.model == SingleTrackModel::dynamic;
  const double back =
      dynamic ? o.rear : 0.0;  // of the reference point, the rear axle, from where the slip angle is [m]
  double* extra = m.extra;
  const CarFooting ground = car_footing(m.footing);
  const auto slip_angle = [&] {
    return dynamic ? blended(o, extra[1] * ground.kept, extra[0], {extra[2], extra[3]}).slip : 0.0;
  };
  if (!(m.dt > 0.0)) {
    const double speed = extra[1] * ground.kept;
    const Lateral now = dynamic ? blended(o, speed, extra[0], {extra[2], extra[3]})
                                : Lateral{speed * std::tan(extra[0]) / o.wheelbase, 0.0};
    const Vec2 v = rotate({speed * std::cos(now.slip), speed * std::sin(now.slip) - back * now.yaw}, m.direction);
    m.twist = {{v.x, v.y, now.yaw}};
    return;
  }
  const Pose before = m.pose;
  const int parts = sub_steps(m.dt);
  const double dt = m.dt / parts;
  Vec2 centre = before.position() + m.direction * back;
  double turned = 0.0;
  for (int k = 0; k < parts; ++k) {
    const double slip = slip_angle();
    const SingleTrackStep step = single_track_part(o, m.control, extra, dt, ground);
    const double bend = step.turn + slip_angle() - slip;
    centre =
        centre + rotate(m.direction, unit(turned + 0.5 * step.turn + step.slip)) * (step.speed * dt * sinc(0.5 * bend));
    turned += step.turn;
    if (ground.kept > 0.0) {  // the rear wheels turn as fast as they drive ahead, and do not feel a slide sideways
      const double ahead = step.speed * std::cos(step.slip), yaw = step.turn / dt;
      add_unmoved(m, {ahead / ground.kept, 0.0}, yaw / ground.kept,
                  {ahead, step.speed * std::sin(step.slip) - back * yaw}, yaw, dt);
    } else {
      add_unmoved(m, {extra[1], 0.0}, 0.0, {}, 0.0, dt);
    }
  }
  const Vec2 heading = rotate(m.direction, unit(turned));
  m.pose.x = centre.x - heading.x * back, m.pose.y = centre.y - heading.y * back;
  m.pose.theta = wrap(before.theta + turned);
  set_mean_twist(m, before, turned);
}

inline std::array<Vec2, 2> wheels(const SingleTrackOptions& o) { return {{{o.front + o.rear, 0.0}, {0.0, 0.0}}}; }

inline Rows rows(const SingleTrackOptions& o) { return {1, -1, 4, true, o.model == SingleTrackModel::dynamic}; }

inline Vec3 deviation(const SingleTrackOptions& o, Vec3 control) { return velocity_deviation(o.alpha, control); }

inline Vec3 constrain(const SingleTrackOptions& o, Vec3 control) {
  const double most = o.mode == SingleTrackMode::steer ? o.psi_max : o.steer_rate;
  control[1] = clip(control[1], -most, most);
  if (o.mode == SingleTrackMode::acceleration) {
    control[0] = clip(control[0], -o.acce_max, o.acce_max);
  } else {
    control[0] = clip(control[0], o.speed_min, o.speed_max);
  }
  return control;
}

inline std::optional<Car> steering(const SingleTrackOptions& o) {
  const Steering mode = o.mode == SingleTrackMode::steer ? Steering::steer : Steering::angular;
  return Car{mode, o.wheelbase, o.psi_max, 0.5, false};
}

/// Steer straight toward the wanted direction, as `acker` does, and roll on while turning.
inline Vec3 follow(const SingleTrackOptions& o, const Wish& wish) {
  constexpr double kMinRolling = 0.2;  // smallest share of the wanted speed
  ForwardWish forward = forward_wish(wish);
  if (forward.error != 0.0)
    forward.speed = std::max(forward.speed, std::min(kMinRolling * norm(wish.velocity), wish.turning.max_forward));
  const double psi = clip(forward.error, -o.psi_max, o.psi_max), rate = turn_rate(psi - wish.extra[0], wish.turning);
  if (o.mode == SingleTrackMode::steer) return {{forward.speed, psi, 0.0}};
  if (o.mode == SingleTrackMode::angular) return {{forward.speed, rate, 0.0}};
  return {{(forward.speed - wish.extra[1]) / std::max(wish.turning.dt, wish.turning.guarantee_time), rate, 0.0}};
}

/// Derivatives of the state of CommonRoad: x, y, steering angle, speed, heading, and of the dynamic model yaw rate and
/// slip angle. Its position is the rear axle in the kinematic model, the centre of mass in the dynamic one.
///
/// Args:
///   state: Steering angle, speed, heading, yaw rate, slip angle.
///   rate, acceleration: Controls [rad/s], [m/s^2].
inline std::vector<double> single_track_rates(const SingleTrackOptions& o, const double (&state)[5], double rate,
                                              double acceleration) {
  const double psi = state[0], speed = state[1];
  const bool stops = std::fabs(psi) >= o.psi_max && rate * psi >= 0.0;
  const double turn = stops ? 0.0 : clip(rate, -o.steer_rate, o.steer_rate), gain = possible(o, speed, acceleration);
  if (o.model == SingleTrackModel::kinematic) {
    const Vec2 way = unit(state[2]) * speed;
    return {way.x, way.y, turn, gain, speed * std::tan(psi) / o.wheelbase};
  }
  const Lateral now{state[3], state[4]};
  const LateralRates change = lateral_rates(o, speed, psi, gain, now);
  const Vec2 way = unit(state[2] + now.slip) * speed;
  return {way.x,
          way.y,
          turn,
          gain,
          now.yaw,
          change.rates.a * now.yaw + change.rates.b * now.slip + change.input[0],
          change.rates.c * now.yaw + change.rates.d * now.slip + change.input[1]};
}

inline void rest(const SingleTrackOptions&, double* extra) { extra[1] = extra[2] = extra[3] = 0.0; }

}  // namespace irsim
