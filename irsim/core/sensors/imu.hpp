// Inertial measurement unit: yaw rate and acceleration with noise, biases and scale errors.
//
// Model: Woodman: An Introduction to Inertial Navigation (UCAM-CL-TR-696, 2007); IEEE Std 952. Noise is given as a
// density, so that it does not depend on the step; the bias of a switched-on device and its wandering are two errors.
#pragma once

#include "fields.hpp"
#include "sensing/gauges.hpp"

namespace irsim {

struct ImuOptions {
  std::array<double, 3> offset;                         // pose in the body frame [m, m, rad]
  double gyro_noise, gyro_bias_std, gyro_drift_std;     // [rad/s/sqrt(Hz)], [rad/s], [rad/s]
  double gyro_drift_time, gyro_scale_std;               // [s], [1]
  double gyro_resolution, gyro_range;                   // [rad/s]
  double accel_noise, accel_bias_std, accel_drift_std;  // [m/s^2/sqrt(Hz)], [m/s^2], [m/s^2]
  double accel_drift_time, accel_scale_std;             // [s], [1]
  double accel_resolution, accel_range;                 // [m/s^2]
  double misalignment_std, tilt_std;                    // of the axes, and of the plane [rad]
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using I = ImuOptions;
    return visit(field("offset", &I::offset), field("gyro_noise", &I::gyro_noise),
                 field("gyro_bias_std", &I::gyro_bias_std), field("gyro_drift_std", &I::gyro_drift_std),
                 field("gyro_drift_time", &I::gyro_drift_time), field("gyro_scale_std", &I::gyro_scale_std),
                 field("gyro_resolution", &I::gyro_resolution), field("gyro_range", &I::gyro_range),
                 field("accel_noise", &I::accel_noise), field("accel_bias_std", &I::accel_bias_std),
                 field("accel_drift_std", &I::accel_drift_std), field("accel_drift_time", &I::accel_drift_time),
                 field("accel_scale_std", &I::accel_scale_std), field("accel_resolution", &I::accel_resolution),
                 field("accel_range", &I::accel_range), field("misalignment_std", &I::misalignment_std),
                 field("tilt_std", &I::tilt_std));
  }
};

inline std::vector<double> beams(const ImuOptions&) { return {}; }
/// Yaw rate [rad/s], acceleration ahead and aside [m/s^2], sensor frame.
inline int readings(const ImuOptions&) { return 3; }
/// Place and velocity of the sensor, the wandering part of the three biases, and what it felt since the last reading.
inline int memory(const ImuOptions&) { return kGaugeMemory + 7 + SinceReading::kNumbers; }

/// A number within a range, as multiples of a resolution.
inline double quantised(double value, double resolution, double range) {
  return nearest_multiple(clip(value, -range, range), resolution);
}

inline void imu(const ImuOptions& o, const Sensing& s) {
  constexpr double kGravity = 9.81;  // [m/s^2]
  const double theta_before = s.memory[3], dt = s.world.step_time;
  Travel travel;
  const Due due = take_note(s, travel);
  if (due == Due::no) return;
  double *const place = s.memory + kGaugeMemory, *const velocity = place + 2, *const drift = place + 4;
  const SinceReading felt{drift + 3};
  const Vec2 at = s.pose.position() + rotate({o.offset[0], o.offset[1]}, s.direction);
  const Wandering gyro{o.gyro_drift_std, o.gyro_drift_time}, accel{o.accel_drift_std, o.accel_drift_time};
  const Draws white = s.draws(), wander = s.draws(1), episode = s.draws(2);
  const auto shift = normals_of(wander, s.scan_number(), {o.gyro_drift_std, o.accel_drift_std});
  if (due == Due::start) {
    place[0] = at.x, place[1] = at.y;
    velocity[0] = velocity[1] = 0.0;
    drift[0] = gyro.first(shift[0]), drift[1] = accel.first(shift[1]), drift[2] = accel.first(shift[2]);
    felt.start();
    std::fill_n(s.readings, 3, 0.0);
    return;
  }
  const Vec2 now = (at - Vec2{place[0], place[1]}) * (1.0 / dt);
  const Vec2 change = (now - Vec2{velocity[0], velocity[1]}) * (1.0 / dt);
  place[0] = at.x, place[1] = at.y, velocity[0] = now.x, velocity[1] = now.y;
  for (int k = 0; k < 3; ++k) drift[k] = (k == 0 ? gyro : accel).next(drift[k], dt, shift[k]);
  // Both velocities are means over a step, so their difference is the acceleration at the time between the steps.
  const auto biases = normals_of(episode, 0, {o.gyro_bias_std, o.accel_bias_std}),
             axes = normals_of(episode, 1, {o.misalignment_std, o.tilt_std}),
             scales = normals_of(episode, 2, {o.gyro_scale_std, o.accel_scale_std});
  const double factor = s.noise(), turned = factor * o.misalignment_std * axes[1];
  const Vec2 true_accel = unrotate(change, unit(theta_before + o.offset[2] + turned));
  const double lean_ahead = std::sin(factor * o.tilt_std * axes[2]),
               lean_aside = std::sin(factor * o.tilt_std * axes[3]);
  double exact[] = {travel.turn / dt, true_accel.x + kGravity * lean_ahead, true_accel.y + kGravity * lean_aside};
  const double steps = felt.add(exact, s.measures());
  if (!s.measures()) return;
  const auto noise = white.normals(s.scan_number());
  const double spread = factor / std::sqrt(steps * dt);
  for (int k = 0; k < 3; ++k) {
    const bool turns = k == 0;
    const double scale = 1.0 + factor * (turns ? o.gyro_scale_std : o.accel_scale_std) * scales[k];
    const double bias = factor * (turns ? o.gyro_bias_std : o.accel_bias_std) * biases[k];
    const double value =
        scale * exact[k] + bias + factor * drift[k] + (turns ? o.gyro_noise : o.accel_noise) * spread * noise[k];
    s.readings[k] =
        quantised(value, turns ? o.gyro_resolution : o.accel_resolution, turns ? o.gyro_range : o.accel_range);
  }
}

}  // namespace irsim
