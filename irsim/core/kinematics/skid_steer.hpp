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
  double track;                          // distance of the tracks, where each touches the ground [m]
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("noise", &SkidSteerOptions::noise), field("alpha", &SkidSteerOptions::alpha),
                 field("believed_track", &SkidSteerOptions::believed_track),
                 field("icr_left", &SkidSteerOptions::icr_left), field("icr_right", &SkidSteerOptions::icr_right),
                 field("icr_ahead", &SkidSteerOptions::icr_ahead),
                 field("traction_left", &SkidSteerOptions::traction_left),
                 field("traction_right", &SkidSteerOptions::traction_right),
                 field("speed_max", &SkidSteerOptions::speed_max), field("track", &SkidSteerOptions::track));
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
  double icr_left = options.icr_left, icr_right = options.icr_right;
  double traction_left = options.traction_left, traction_right = options.traction_right;
  if (m.footing != nullptr) {
    const Footing &under_left = m.footing[0], &under_right = m.footing[1];
    if (under_left.spread > 0.0)
      icr_left = 0.5 * under_left.spread * options.track, traction_left = under_left.traction;
    if (under_right.spread > 0.0)
      icr_right = -0.5 * under_right.spread * options.track, traction_right = under_right.traction;
    traction_left *= 1.0 - under_left.slip, traction_right *= 1.0 - under_right.slip;
  }
  const double l = traction_left * left, r = traction_right * right;
  const double apart = icr_left - icr_right, rate = (r - l) / apart;
  move_on_ground(m, {0.5 * (left + right), 0.0}, (right - left) / options.believed_track,
                 {(r * icr_left - l * icr_right) / apart, -options.icr_ahead * rate}, rate);
}

inline std::array<Vec2, 2> wheels(const SkidSteerOptions& options) { return side_by_side(options.track); }

inline Rows rows(const SkidSteerOptions&) { return {1, 1, 2, false, true}; }

inline Vec3 deviation(const SkidSteerOptions& options, Vec3 control) {
  return velocity_deviation(options.alpha, control);
}

inline Vec3 follow(const SkidSteerOptions&, const Wish& wish) {
  const ForwardWish forward = forward_wish(wish);
  return {{forward.speed, turn_rate(forward.error, wish.turning), 0.0}};
}

}  // namespace irsim
