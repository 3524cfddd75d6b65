// Satellite navigation: a position with an error that wanders and noise on top, and areas without reception.
#pragma once

#include "fields.hpp"
#include "sensing/gauges.hpp"

namespace irsim {

struct GnssOptions {
  std::array<double, 3> offset;  // of the antenna in the body frame [m, m, rad]
  double std;                    // of the noise from reading to reading [m]
  double drift_std, drift_time;  // of the error that wanders [m], and the time in which it falls to 1 / e [s]
  bool rtk;                      // whether corrections make it exact for a while
  double fixed_std, fixed_time;  // of positions with all corrections [m], and how long these last on average [s]
  double float_std, float_time;  // of positions with some of them
  std::vector<int> blocked;      // zones without reception
  std::vector<int> reflecting;   // zones in which reflections make errors larger
  double reflection;             // the factor
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using G = GnssOptions;
    return visit(field("offset", &G::offset), field("std", &G::std), field("drift_std", &G::drift_std),
                 field("drift_time", &G::drift_time), field("rtk", &G::rtk), field("fixed_std", &G::fixed_std),
                 field("fixed_time", &G::fixed_time), field("float_std", &G::float_std),
                 field("float_time", &G::float_time), field("blocked", &G::blocked),
                 field("reflecting", &G::reflecting), field("reflection", &G::reflection));
  }
};

inline std::vector<double> beams(const GnssOptions&) { return {}; }
/// x, y [m], world frame; NaN without reception; quality: 0 none, 1 alone, 2 some corrections, 3 all; its standard
/// deviation [m].
inline int readings(const GnssOptions&) { return 4; }
/// The wandering error x, y, and whether all corrections are there.
inline int memory(const GnssOptions&) { return kGaugeMemory + 3; }

inline void gnss(const GnssOptions& o, const Sensing& s) {
  Travel travel;
  const Due due = take_note(s, travel);
  if (due == Due::no) return;
  double *const error = s.memory + kGaugeMemory, &fixed = error[2];
  const Wandering drift{o.drift_std, o.drift_time};
  const Draws wander = s.draws(1);
  const double dt = s.world.step_time;
  const auto shift = wander.normals(2 * s.scan_number());
  if (due == Due::start) {
    error[0] = drift.first(shift[0]), error[1] = drift.first(shift[1]);
    fixed = 1.0;
  } else {
    for (int k = 0; k < 2; ++k) error[k] = drift.next(error[k], dt, shift[k]);
    const double stays = fixed > 0.0 ? o.fixed_time : o.float_time;
    const double change = wander.uniform(8 * s.scan_number() + 4);
    if (stays > 0.0 && change < 1.0 - std::exp(-dt / stays)) fixed = 1.0 - fixed;
  }
  const Vec2 at = s.pose.position() + rotate({o.offset[0], o.offset[1]}, s.direction);
  if (in_zones(s.world, o.blocked, at)) {
    s.readings[0] = s.readings[1] = s.readings[3] = kNone;
    s.readings[2] = 0.0;
    return;
  }
  const double worse = s.noise() * (in_zones(s.world, o.reflecting, at) ? o.reflection : 1.0);
  const auto noise = s.draws().normals(s.scan_number());
  const double std = worse * (!o.rtk ? o.std : fixed > 0.0 ? o.fixed_std : o.float_std);
  const double wandering = o.rtk ? 0.0 : worse;
  s.readings[0] = at.x + wandering * error[0] + std * noise[0];
  s.readings[1] = at.y + wandering * error[1] + std * noise[1];
  s.readings[2] = !o.rtk ? 1.0 : fixed > 0.0 ? 3.0 : 2.0;
  s.readings[3] = std::hypot(std, wandering * o.drift_std);
}

}  // namespace irsim
