// Skid steering: forward speed and yaw rate become speeds of the tracks, which slide sideways when the body turns.
#pragma once

#include "drive.hpp"
#include "fields.hpp"

namespace irsim {

struct SkidSteerOptions {
  bool noise;
  std::array<double, 4> alpha;
  double believed_track;                 // distance of the tracks with which the controller computes their speeds [m]
  double icr_left, icr_right;            // left of the body at which each track touches the ground without sliding [m]
  double icr_ahead;                      // ahead of the reference point at which the body turns [m]
  double traction_left, traction_right;  // speed over ground per speed of each track [1]
  double speed_max;                      // of a track [m/s], may be infinite
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(
        field("noise", &SkidSteerOptions::noise), field("alpha", &SkidSteerOptions::alpha),
        field("believed_track", &SkidSteerOptions::believed_track), field("icr_left", &SkidSteerOptions::icr_left),
        field("icr_right", &SkidSteerOptions::icr_right), field("icr_ahead", &SkidSteerOptions::icr_ahead),
        field("traction_left", &SkidSteerOptions::traction_left),
        field("traction_right", &SkidSteerOptions::traction_right), field("speed_max", &SkidSteerOptions::speed_max));
  }
};

/// Each track rolls about an instantaneous centre of rotation of its own. With these centres the motion follows from
/// the speeds of the tracks (Mandow et al.: "Experimental kinematics for wheeled skid-steer mobile robots", IROS 2007).
/// The extra rows are these speeds, left and right [m/s].
inline void skid_steer(const SkidSteerOptions& options, const Motion& m) {
  double left = m.control[0] - 0.5 * options.believed_track * m.control[1];
  double right = m.control[0] + 0.5 * options.believed_track * m.control[1];
  const double fastest = std::max(std::fabs(left), std::fabs(right));
  if (fastest > options.speed_max) left *= options.speed_max / fastest, right *= options.speed_max / fastest;
  m.extra[0] = left, m.extra[1] = right;
  const double l = options.traction_left * left, r = options.traction_right * right;
  const double apart = options.icr_left - options.icr_right, rate = (r - l) / apart;
  move(m, {(r * options.icr_left - l * options.icr_right) / apart, -options.icr_ahead * rate}, rate);
}

inline Rows rows(const SkidSteerOptions&) { return {1, 1, 2}; }

inline Vec3 deviation(const SkidSteerOptions& options, Vec3 control) {
  return velocity_deviation(options.alpha, control);
}

inline Vec3 follow(const SkidSteerOptions&, const Wish& wish) {
  const ForwardWish forward = forward_wish(wish);
  return {{forward.speed, turn_rate(forward.error, wish.turning), 0.0}};
}

}  // namespace irsim
