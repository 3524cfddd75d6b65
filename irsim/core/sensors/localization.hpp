// Where a robot believes it is: smooth between corrections, with a jump at each of them, as of a particle filter on a
// map.
#pragma once

#include "fields.hpp"
#include "sensing/gauges.hpp"

namespace irsim {

struct LocalizationOptions {
  double position_std, heading_std;  // of the error after a correction [m], [rad]
  double time;                       // in which this error falls to 1 / e [s]
  double min_distance, min_turn;     // motion since the last correction that brings the next [m], [rad]
  double distance_noise, heading_noise, turning_noise;  // of the motion between corrections, see Drift
  double jumps_per_km, jump_std;                        // gross errors: how often, and their size [m]
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using L = LocalizationOptions;
    return visit(field("position_std", &L::position_std), field("heading_std", &L::heading_std),
                 field("time", &L::time), field("min_distance", &L::min_distance), field("min_turn", &L::min_turn),
                 field("distance_noise", &L::distance_noise), field("heading_noise", &L::heading_noise),
                 field("turning_noise", &L::turning_noise), field("jumps_per_km", &L::jumps_per_km),
                 field("jump_std", &L::jump_std));
  }
};

inline std::vector<double> beams(const LocalizationOptions&) { return {}; }
/// x, y [m], heading [rad], world frame; 1 at the first reading after a correction.
inline int readings(const LocalizationOptions&) { return 4; }
/// The believed pose; the error of the last correction; distance, turn and time since then; whether there was one since
/// the last reading.
inline int memory(const LocalizationOptions&) { return kGaugeMemory + 10; }

inline void localization(const LocalizationOptions& o, const Sensing& s) {
  Travel travel;
  const Due due = take_note(s, travel);
  if (due == Due::no) return;
  double *const pose = s.memory + kGaugeMemory, *const error = pose + 3, *const since = pose + 6;
  const double dt = s.world.step_time, stds[] = {o.position_std, o.position_std, o.heading_std};
  const Draws wander = s.draws(1);
  bool corrects = due == Due::start;
  if (due == Due::step) {
    const auto draw = normals_of(s.draws(), s.scan_number(), {o.distance_noise, o.heading_noise, o.turning_noise});
    const double noise = s.noise();
    const Drift drift{noise * o.distance_noise, noise * o.heading_noise, noise * o.turning_noise};
    travel_on(pose, drift.add(travel, draw[0], draw[1]));
    const double way = std::hypot(travel.ahead, travel.aside);
    since[0] += way, since[1] += std::fabs(travel.turn), since[2] += dt;
    constexpr double kRounding = 1e-9;  // of a way that is a sum of steps
    corrects = since[0] >= o.min_distance - kRounding || since[1] >= o.min_turn - kRounding;
  }
  if (corrects) {
    const auto shift = normals_of(wander, 2 * s.scan_number(), {o.position_std, o.heading_std});
    for (int k = 0; k < 3; ++k) {
      const Wandering wandering{stds[k], o.time};
      error[k] = due == Due::start ? wandering.first(shift[k])
                 : o.time > 0.0    ? wandering.next(error[k], since[2], shift[k])
                                   : wandering.first(shift[k]);
    }
    const double jump = wander.uniform(8 * s.scan_number() + 4);
    if (jump < 1.0 - std::exp(-o.jumps_per_km * since[0] / 1000.0)) {
      const auto size = s.draws(2).normals(s.scan_number());
      error[0] += o.jump_std * size[0], error[1] += o.jump_std * size[1];
    }
    const double noise = s.noise();
    pose[0] = s.pose.x + noise * error[0], pose[1] = s.pose.y + noise * error[1];
    pose[2] = wrap(s.pose.theta + noise * error[2]);
    std::fill_n(since, 3, 0.0);
  }
  double& corrected = since[3];
  if (due == Due::start) corrected = 0.0;
  if (corrects && due == Due::step) corrected = 1.0;
  if (!s.measures()) return;
  std::copy_n(pose, 3, s.readings);
  s.readings[3] = corrected;
  corrected = 0.0;
}

}  // namespace irsim
