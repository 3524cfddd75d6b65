// Planar lidar: exact ranges to the boundaries of everything that is not unobstructed (reference: section 7).
#pragma once

#include "fields.hpp"
#include "raycast.hpp"
#include "sensing.hpp"

namespace irsim {

struct Lidar2dOptions {
  double range_min, range_max;  // [m]
  double angle_range;           // [rad]
  int number;                   // of beams
  bool noise;
  double std;                    // of the range of a hit [m]
  double angle_std;              // of the direction of a beam [rad]
  std::array<double, 3> offset;  // sensor pose in the body frame [m, m, rad]
  bool has_velocity;             // velocities are looked up by `hits`; nothing to do here
  static constexpr auto fields() {
    using L = Lidar2dOptions;
    return std::make_tuple(field("range_min", &L::range_min), field("range_max", &L::range_max),
                           field("angle_range", &L::angle_range), field("number", &L::number),
                           field("noise", &L::noise), field("std", &L::std), field("angle_std", &L::angle_std),
                           field("offset", &L::offset), field("has_velocity", &L::has_velocity));
  }
};

/// Evenly spaced from -angle_range / 2 to angle_range / 2; a single beam looks straight ahead.
inline std::vector<double> beams(const Lidar2dOptions& options) {
  const int n = std::max(0, options.number);
  std::vector<double> angles(n, 0.0);
  if (n < 2) return angles;
  const double first = -options.angle_range / 2.0, last = options.angle_range / 2.0, step = (last - first) / (n - 1);
  for (int i = 0; i < n; ++i) angles[i] = first + i * step;
  angles[n - 1] = last;
  return angles;
}

inline void lidar2d(const Lidar2dOptions& options, const Sensing& s) {
  const int n = s.mount.count;
  const Pose& pose = s.state.pose[s.row()];
  const Vec2 body = s.state.heading(s.row());
  const Vec2 origin = pose.position() + rotate({options.offset[0], options.offset[1]}, body);
  const double mounted = options.offset[2];
  const Vec2 heading = mounted == 0.0 ? body : unit(wrap(pose.theta + mounted));
  const bool jitter = options.noise && options.angle_std > 0.0, noisy = options.noise && options.std > 0.0;
  NormalDraws normal(s.draws());  // of a scan: n range errors, then n direction errors
  const std::uint64_t first_draw = 2 * static_cast<std::uint64_t>(s.state.count[s.w]) * static_cast<std::uint64_t>(n);

  Fan fan(s.buffers, origin, heading, s.mount, options.range_max);
  for (int i = 0; i < n; ++i) {
    Vec2 beam{s.mount.cosine[i], s.mount.sine[i]};
    if (jitter) {
      const double error = options.angle_std * normal(first_draw + n + i);
      beam = unit(s.mount.angle[i] + error);
      fan.widen(error);
    }
    fan.aim(i, rotate(beam, heading));
  }
  for (const int object : s.world.visible) {
    if (object == s.mount.object) continue;
    const auto [centre, radius] = s.state.bounds(s.world, s.w, object);
    fan.consider(object, centre, radius);
  }
  fan.cast([&](int object) { return s.state.footprint(s.world, s.w, object); });
  for (int i = 0; i < n; ++i) {
    const int hit = fan.hit(i);
    double range = hit < 0 ? options.range_max : fan.range(i);
    if (hit >= 0 && noisy) range += options.std * normal(first_draw + i);
    s.ranges[i] = clip(range, options.range_min, options.range_max);
    s.hits[i] = hit;
    s.valid[i] = hit >= 0 && range >= options.range_min && range <= options.range_max;
  }
}

}  // namespace irsim
