// Cliff sensor: points under a robot that see whether there is floor.
#pragma once

#include "fields.hpp"
#include "sensing/gauges.hpp"

namespace irsim {

struct CliffOptions {
  std::vector<std::array<double, 2>> points;  // body frame [m]
  std::vector<int> zones;                     // where the floor ends
  double miss_share, false_share;             // of readings over a drop that see floor, and the other way round
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using C = CliffOptions;
    return visit(field("points", &C::points), field("zones", &C::zones), field("miss_share", &C::miss_share),
                 field("false_share", &C::false_share));
  }
};

inline std::vector<double> beams(const CliffOptions&) { return {}; }
/// For each point 1 without floor under it.
inline int readings(const CliffOptions& options) { return static_cast<int>(options.points.size()); }

inline void cliff(const CliffOptions& o, const Sensing& s) {
  const int count = readings(o);
  UniformDraws luck(s.draws(1));
  for (int k = 0; k < count; ++k) {
    const Vec2 at = s.pose.position() + rotate({o.points[k][0], o.points[k][1]}, s.direction);
    const bool drop = in_zones(s.world, o.zones, at);
    const double chance = luck(s.scan_number() * static_cast<std::uint64_t>(count) + k);
    s.readings[k] = drop != (chance < (drop ? o.miss_share : o.false_share));
  }
}

}  // namespace irsim
