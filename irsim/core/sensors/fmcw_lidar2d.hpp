// Frequency-modulated lidar: range and, by the Doppler shift, radial velocity of each hit.
#pragma once

#include <optional>

#include "fields.hpp"
#include "sensing/beams.hpp"
#include "sensing/sweep.hpp"

namespace irsim {

struct FmcwLidar2dOptions {
  double range_min, range_max;   // [m]
  double angle_range;            // [rad]
  int number;                    // number of beams
  bool endpoint;                 // whether the last beam points to the end of the range
  bool noise;                    // whether ranges and directions are noisy
  double std;                    // standard deviation of ranges [m]
  double angle_std;              // standard deviation of beam directions [rad]
  std::array<double, 3> offset;  // sensor pose in the body frame [m, m, rad]
  bool motion_compensate;        // whether the motion of the carrier is subtracted
  double velocity_noise_std;     // standard deviation of radial velocities, also without `noise` [m/s]
  std::optional<LidarErrors> realism;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using F = FmcwLidar2dOptions;
    return visit(field("range_min", &F::range_min), field("range_max", &F::range_max),
                 field("angle_range", &F::angle_range), field("number", &F::number), field("endpoint", &F::endpoint),
                 field("noise", &F::noise), field("std", &F::std), field("angle_std", &F::angle_std),
                 field("offset", &F::offset), field("motion_compensate", &F::motion_compensate),
                 field("velocity_noise_std", &F::velocity_noise_std), field("realism", &F::realism));
  }
};

inline std::vector<double> beams(const FmcwLidar2dOptions& options) {
  return spread_beams(options.angle_range, options.number, options.endpoint);
}

inline int velocity_rows(const FmcwLidar2dOptions&) { return 1; }

inline int sweep_parts(const FmcwLidar2dOptions& options) {
  return options.realism && options.realism->beam_time > 0.0 ? options.realism->segments : 1;
}

/// Write the radial velocities of hits; other beams read 0. The noise of beam i is the normal draw `first + i`.
inline void write_radial_velocities(const FmcwLidar2dOptions& options, const Sensing& s, const Fan& fan,
                                    std::uint64_t first) {
  NormalDraws error(s.draws());
  const Vec2 own = options.motion_compensate ? Vec2{} : s.object_velocities[s.mount.object];
  for (int i = 0; i < s.mount.count; ++i) {
    double receding = 0.0;
    if (s.valid[i] && s.hits[i] >= 0) {
      receding = dot(s.object_velocities[s.hits[i]] - own, fan.beam(i));
      if (options.velocity_noise_std > 0.0) receding += s.noise() * options.velocity_noise_std * error(first + i);
    }
    s.velocities[i] = receding;
  }
}

/// Take a scan. A hit whose (noisy) range is outside the limits is not valid, and its velocity is 0.
inline void fmcw_lidar2d(const FmcwLidar2dOptions& options, const Sensing& s) {
  const int n = s.mount.count;
  if (n == 0) return;
  // draws of a scan: n range errors, n direction errors, n velocity errors
  const std::uint64_t first_draw = 3 * s.scan_number() * static_cast<std::uint64_t>(n);
  const bool noisy = options.noise && options.std > 0.0;
  if (options.realism) {
    const RangeLimits limits{options.range_min, options.range_max, noisy ? options.std : 0.0};
    const EpisodeErrors episode = episode_errors(*options.realism, s);
    return sweep(*options.realism, s, [&](const Sensing& part) {
      const std::uint64_t first = first_draw + part.first_beam;
      const Fan fan = cast_beams(options, part, first + n);
      write_with_errors(*options.realism, limits, part, fan, episode, first);
      write_radial_velocities(options, part, fan, first + 2 * n);
    });
  }
  const Fan fan = cast_beams(options, s, first_draw + n);
  NormalDraws normal(s.draws());
  for (int i = 0; i < n; ++i) {
    const int hit = fan.hit(i);
    double range = hit < 0 ? options.range_max : fan.range(i);
    if (hit >= 0 && noisy) range += s.noise() * options.std * normal(first_draw + i);
    s.ranges[i] = clip(range, options.range_min, options.range_max);
    s.hits[i] = hit;
    s.valid[i] = hit >= 0 && range >= options.range_min && range <= options.range_max;
  }
  write_radial_velocities(options, s, fan, first_draw + 2 * n);
}

}  // namespace irsim
