// Differential drive: forward speed and yaw rate.
#pragma once

#include "drive.hpp"
#include "fields.hpp"

namespace irsim {

struct DiffOptions {
  bool noise;
  std::array<double, 4> alpha;
  double track;  // distance of the wheels [m]
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("noise", &DiffOptions::noise), field("alpha", &DiffOptions::alpha),
                 field("track", &DiffOptions::track));
  }
};

inline void diff(const DiffOptions& options, const Motion& m) {
  const Vec2 speeds{m.control[0], m.control[1]}, ground = over_ground(speeds, 0.5 * options.track, m.footing);
  move_on_ground(m, {speeds.x, 0.0}, speeds.y, {ground.x, 0.0}, ground.y);
}

inline std::array<Vec2, 2> wheels(const DiffOptions& options) { return side_by_side(options.track); }

inline Rows rows(const DiffOptions&) { return {1, 1}; }

inline Vec3 deviation(const DiffOptions& options, Vec3 control) { return velocity_deviation(options.alpha, control); }

inline Vec3 follow(const DiffOptions&, const Wish& wish) {
  const ForwardWish forward = forward_wish(wish);
  return {{forward.speed, turn_rate(forward.error, wish.turning), 0.0}};
}

}  // namespace irsim
