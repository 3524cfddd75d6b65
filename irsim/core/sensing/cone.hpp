// One range for a whole cone: what sonars and infrared sensors have in common.
#pragma once

#include "fields.hpp"
#include "sensing/beams.hpp"
#include "sensing/lidar_errors.hpp"
#include "sensing/surface.hpp"

namespace irsim {

struct ConeOptions {
  std::array<double, 3> offset;  // sensor pose in the body frame [m, m, rad]
  double range_min, range_max;   // [m]
  double cone;                   // full angle [rad]
  double incidence_max;          // largest angle between a ray and the normal of a surface that returns it [rad]
  double std, std_per_meter;     // of the range [m], and its growth with the range [1]
  double resolution;             // ranges are multiples of this [m]
  double dropout;                // share of readings without an echo
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using C = ConeOptions;
    return visit(field("offset", &C::offset), field("range_min", &C::range_min), field("range_max", &C::range_max),
                 field("cone", &C::cone), field("incidence_max", &C::incidence_max), field("std", &C::std),
                 field("std_per_meter", &C::std_per_meter), field("resolution", &C::resolution),
                 field("dropout", &C::dropout));
  }
};

/// Rays that stand for the cone, at most half a degree apart, one of them along its axis. At range r they miss nothing
/// that is wider than r / 115, and a wall ahead reads at most 1e-5 of the range too far.
inline std::vector<double> beams(const ConeOptions& options) {
  constexpr double kSpacing = 0.00873;  // [rad]
  const int aside = static_cast<int>(std::ceil(0.5 * options.cone / kSpacing));
  return spread_beams(options.cone, 2 * aside + 1, true);
}

/// Readings: range [m]; 1 if there was an echo within the limits; full angle of the cone [rad].
constexpr int kConeReadings = 3;

/// Distance to the nearest surface in the cone that returns a ray [m], infinite without one. `light` passes glass and
/// follows mirrors, which sound does not.
inline double nearest_echo(const ConeOptions& o, const Sensing& s, bool light) {
  struct Aim {
    std::array<double, 3> offset;
    double range_max;
    bool noise;
    double angle_std;
  };
  const Fan fan = cast_beams(Aim{o.offset, o.range_max, false, 0.0}, s, 0);
  BeamBuffers& beams = s.buffers;
  Surface surface(s);
  const bool steep = o.incidence_max < 0.5 * kPi, optics = light && s.world.optics;
  if (optics) follow_light(s, fan, surface);
  const double least = steep ? std::cos(o.incidence_max) : 0.0;
  double nearest = kInfinity;
  for (int i = 0; i < fan.count(); ++i) {
    if (beams.hit[i] < 0 || beams.range[i] >= nearest) continue;
    if (steep && (optics ? beams.cosine[i] : surface.cosine(fan, i)) < least) continue;
    nearest = beams.range[i];
  }
  return nearest;
}

/// The range that is measured for an exact one, infinite without an echo. `luck` is a uniform draw.
inline double measured(const ConeOptions& o, const Sensing& s, double exact, double luck) {
  if (exact == kInfinity || luck < o.dropout) return kInfinity;
  const double sigma = s.noise() * std::hypot(o.std, o.std_per_meter * exact);
  const double range = sigma > 0.0 ? std::max(0.0, exact + sigma * s.draws().normals(s.scan_number())[0]) : exact;
  return nearest_multiple(range, o.resolution);
}

/// Write the readings for a range; an infinite one reads the greatest range.
inline void report(const ConeOptions& o, const Sensing& s, double range) {
  s.readings[0] = clip(range, o.range_min, o.range_max);
  s.readings[1] = range >= o.range_min && range <= o.range_max;
  s.readings[2] = o.cone;
}

}  // namespace irsim
