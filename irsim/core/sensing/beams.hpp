// The common part of planar range sensors: the directions of their beams, and casting them.
#pragma once

#include "sensing.hpp"
#include "sensing/raycast.hpp"

namespace irsim {

/// Angles evenly spaced from -angle_range / 2 to angle_range / 2, the first one included and the last one if
/// `endpoint`; a single beam points straight ahead.
inline std::vector<double> spread_beams(double angle_range, int number, bool endpoint) {
  const int n = std::max(0, number);
  std::vector<double> angles(n, 0.0);
  if (n < 2) return angles;
  const double first = -angle_range / 2.0, last = angle_range / 2.0, step = (last - first) / (endpoint ? n - 1 : n);
  for (int i = 0; i < n; ++i) angles[i] = first + i * step;
  if (endpoint) angles[n - 1] = last;
  return angles;
}

/// Aim every beam of a mount at its nominal angle. `heading`: cosine and sine of the sensor heading, world frame.
inline void aim_all(Fan& fan, const Mount& mount, Vec2 heading) {
  for (int i = 0; i < mount.count; ++i) fan.aim(i, rotate({mount.cosine[i], mount.sine[i]}, heading));
}

/// Cast at all objects that are not unobstructed and for which `seen(object)` holds, at the time of the beams.
template <class Seen>
void cast_at(Fan& fan, const Sensing& s, Seen&& seen) {
  for (const int object : s.world.visible) {
    if (!seen(object)) continue;
    const auto [centre, radius] = s.bounds(object);
    fan.consider(object, centre, radius);
  }
  fan.cast([&](int object) { return s.footprint(object); });
}

/// Cast at all objects that are not unobstructed, except `carrier`.
inline void cast_at_visible(Fan& fan, const World& world, const State& state, int w, int carrier) {
  for (const int object : world.visible) {
    if (object == carrier) continue;
    const auto [centre, radius] = state.bounds(world, w, object);
    fan.consider(object, centre, radius);
  }
  fan.cast([&](int object) { return state.footprint(world, w, object); });
}

/// Take a scan of a sensor that has the options `offset`, `range_max`, `noise` and `angle_std`. With noise, beam i
/// deviates by `angle_std` times the normal draw `first_error + i`.
template <class Options>
Fan cast_beams(const Options& options, const Sensing& s, std::uint64_t first_error) {
  const int n = s.mount.count;
  const Vec2 origin = s.pose.position() + rotate({options.offset[0], options.offset[1]}, s.direction);
  const double mounted = options.offset[2];
  const Vec2 heading = mounted == 0.0 ? s.direction : unit(wrap(s.pose.theta + mounted));
  Fan fan(s.buffers, origin, heading, s.mount, options.range_max);
  const bool shaky = options.noise && options.angle_std > 0.0;
  if (s.spin != 0.0) {
    // Even and odd beams turn on by themselves, because each turn waits for the one before.
    const Vec2 on = unit(s.spin), twice = rotate(on, on), first = rotate(unit(-0.5 * (n - 1) * s.spin), heading);
    Vec2 turned[] = {first, rotate(first, on)};
    const double most = std::fabs(0.5 * (n - 1) * s.spin);
    fan.widen(most);
    NormalDraws normal(s.draws());
    for (int i = 0; i < n; ++i) {
      Vec2 nominal{s.mount.cosine[i], s.mount.sine[i]};
      if (shaky) {
        const double error = s.noise() * options.angle_std * normal(first_error + i);
        fan.widen(std::fabs(error) + most);
        nominal = unit(s.mount.angle[i] + error);
      }
      fan.aim(i, rotate(nominal, turned[i % 2]));
      turned[i % 2] = rotate(turned[i % 2], twice);
    }
  } else if (shaky) {
    NormalDraws normal(s.draws());
    for (int i = 0; i < n; ++i) {
      const double error = s.noise() * options.angle_std * normal(first_error + i);
      fan.widen(error);
      fan.aim(i, rotate(unit(s.mount.angle[i] + error), heading));
    }
  } else {
    aim_all(fan, s.mount, heading);
  }
  if (s.earlier) {
    cast_at(fan, s, [&](int object) { return object != s.mount.object; });
  } else {
    cast_at_visible(fan, s.world, s.state, s.w, s.mount.object);
  }
  return fan;
}

}  // namespace irsim
