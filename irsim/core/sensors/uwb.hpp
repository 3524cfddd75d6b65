// Ultra-wideband radio: ranges to anchors, which walls on the way make longer.
#pragma once

#include "fields.hpp"
#include "geometry/predicates.hpp"
#include "sensing.hpp"
#include "sensing/crossings.hpp"

namespace irsim {

struct UwbOptions {
  std::vector<std::array<double, 2>> anchors;  // world frame [m]
  std::array<double, 3> offset;                // of the antenna in the body frame [m, m, rad]
  double range_max;                            // [m]
  double std;                                  // of a range along a free line of sight [m]
  double nlos_bias, nlos_std;                  // what each wall on the way adds, and its standard deviation [m]
  double outlier_share, outlier_mean;          // of ranges that are too long by chance, and by how much on average [m]
  double dropout;                              // share of ranges that are missing
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using U = UwbOptions;
    return visit(field("anchors", &U::anchors), field("offset", &U::offset), field("range_max", &U::range_max),
                 field("std", &U::std), field("nlos_bias", &U::nlos_bias), field("nlos_std", &U::nlos_std),
                 field("outlier_share", &U::outlier_share), field("outlier_mean", &U::outlier_mean),
                 field("dropout", &U::dropout));
  }
};

inline std::vector<double> beams(const UwbOptions&) { return {}; }
/// The range to each anchor [m]; NaN without one.
inline int readings(const UwbOptions& options) { return static_cast<int>(options.anchors.size()); }

/// Number of walls and bodies, but for the carrier, between two points.
inline int walls_between(const Sensing& s, Vec2 from, Vec2 to) {
  int count = 0;
  for (const int object : s.world.visible) {
    if (object == s.mount.object) continue;
    const auto [centre, radius] = s.bounds(object);
    if (squared(nearest_on_segment(from, to, centre) - centre) <= radius * radius * (1.0 + 1e-9))
      count += crossings(s.footprint(object), from, to);
  }
  return count;
}

inline void uwb(const UwbOptions& o, const Sensing& s) {
  const Vec2 tag = s.pose.position() + rotate({o.offset[0], o.offset[1]}, s.direction);
  const int count = readings(o);
  NormalDraws normal(s.draws());
  const Draws luck = s.draws(1);
  for (int k = 0; k < count; ++k) {
    const std::uint64_t draw = s.scan_number() * static_cast<std::uint64_t>(count) + k;
    const auto chance = luck.uniforms(draw);
    const Vec2 anchor{o.anchors[k][0], o.anchors[k][1]};
    const double exact = norm(anchor - tag);
    s.readings[k] = kNone;
    if (exact > o.range_max || chance[0] < o.dropout) continue;
    const int walls = walls_between(s, tag, anchor);
    double range = exact + walls * o.nlos_bias;
    range += s.noise() * std::sqrt(o.std * o.std + walls * o.nlos_std * o.nlos_std) * normal(draw);
    if (chance[1] < o.outlier_share) range -= o.outlier_mean * std::log(1.0 - chance[2]);
    s.readings[k] = std::max(0.0, range);
  }
}

}  // namespace irsim
