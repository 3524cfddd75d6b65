// Planar lidar: exact ranges to the boundaries of all objects that are not unobstructed.
#pragma once

#include <optional>

#include "fields.hpp"
#include "sensing/beams.hpp"
#include "sensing/sweep.hpp"

namespace irsim {

struct Lidar2dOptions {
  double range_min, range_max;   // [m]
  double angle_range;            // [rad]
  int number;                    // number of beams
  bool endpoint;                 // whether the last beam points to the end of the range
  bool noise;                    // whether ranges and directions are noisy
  double std;                    // standard deviation of ranges [m]
  double angle_std;              // standard deviation of beam directions [rad]
  std::array<double, 3> offset;  // sensor pose in the body frame [m, m, rad]
  bool has_velocity;             // whether the world-frame velocity of the object hit by each beam is recorded
  std::optional<LidarErrors> realism;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using L = Lidar2dOptions;
    return visit(field("range_min", &L::range_min), field("range_max", &L::range_max),
                 field("angle_range", &L::angle_range), field("number", &L::number), field("endpoint", &L::endpoint),
                 field("noise", &L::noise), field("std", &L::std), field("angle_std", &L::angle_std),
                 field("offset", &L::offset), field("has_velocity", &L::has_velocity), field("realism", &L::realism));
  }
};

inline std::vector<double> beams(const Lidar2dOptions& options) {
  return spread_beams(options.angle_range, options.number, options.endpoint);
}

inline int velocity_rows(const Lidar2dOptions& options) { return options.has_velocity ? 2 : 0; }

/// World-frame velocities of the objects that were hit, if they are recorded.
inline void write_velocities(const Lidar2dOptions& options, const Sensing& s) {
  const int n = s.mount.count;
  if (!options.has_velocity) return;
  for (int i = 0; i < n; ++i) {
    const Vec2 v = s.hits[i] < 0 ? Vec2{} : s.object_velocities[s.hits[i]];
    s.velocities[i] = v.x, s.velocities[n + i] = v.y;
  }
}

/// Whether scans take time, and the parts in which they are cast.
inline int sweep_parts(const Lidar2dOptions& options) {
  return options.realism && options.realism->beam_time > 0.0 ? options.realism->segments : 1;
}

/// The draw of the range of beam 0; a scan has n draws of ranges and n of directions.
inline std::uint64_t first_draw_of(const Sensing& s) {
  return 2 * s.scan_number() * static_cast<std::uint64_t>(s.mount.count);
}

/// Take a scan whose ranges have the errors of `realism`, and the error of a depth camera if `depth` is given.
inline void scan_with_errors(const Lidar2dOptions& options, const Sensing& s, const DepthErrors* depth = nullptr) {
  const double std = options.noise && options.std > 0.0 ? options.std : 0.0;
  const RangeLimits limits{options.range_min, options.range_max, std, depth};
  const EpisodeErrors episode = episode_errors(*options.realism, s);
  sweep(*options.realism, s, [&](const Sensing& part) {
    const std::uint64_t first = first_draw_of(s) + part.first_beam;
    const Fan fan = cast_beams(options, part, first + s.mount.count);
    write_with_errors(*options.realism, limits, part, fan, episode, first);
  });
  write_velocities(options, s);
}

inline void lidar2d(const Lidar2dOptions& options, const Sensing& s) {
  if (options.realism) return scan_with_errors(options, s);
  const int n = s.mount.count;
  const std::uint64_t first_draw = first_draw_of(s);
  const bool noisy = options.noise && options.std > 0.0;
  const Fan fan = cast_beams(options, s, first_draw + n);
  NormalDraws normal(s.draws());
  // Copies, because for all that the compiler knows, writing a byte of `valid` could change what these point to.
  const double nearest = options.range_min, farthest = options.range_max, *measured = fan.ranges();
  const std::int32_t* const hits = fan.hits();
  double* const ranges = s.ranges;
  std::uint8_t* const valid = s.valid;
  std::copy(hits, hits + n, s.hits);
  for (int i = 0; i < n; ++i) {
    const bool hit = hits[i] >= 0;
    double range = hit ? measured[i] : farthest;
    if (hit && noisy) range += s.noise() * options.std * normal(first_draw + i);
    ranges[i] = clip(range, nearest, farthest);
    valid[i] = hit && range >= nearest && range <= farthest;
  }
  write_velocities(options, s);
}

}  // namespace irsim
