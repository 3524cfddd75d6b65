// Holonomic drive that also turns: forward and lateral speed in the body frame, yaw rate.
#pragma once

#include "drive.hpp"
#include "fields.hpp"

namespace irsim {

struct OmniAngularOptions {
  bool noise;
  std::array<double, 3> alpha;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("noise", &OmniAngularOptions::noise), field("alpha", &OmniAngularOptions::alpha));
  }
};

inline void omni_angular(const OmniAngularOptions&, const Motion& m) {
  const Vec2 wheels{m.control[0], m.control[1]};
  const double kept = m.footing == nullptr ? 1.0 : 1.0 - m.footing->slip;
  move_on_ground(m, wheels, m.control[2], wheels * kept, m.control[2] * kept);
}

inline Rows rows(const OmniAngularOptions&) { return {2, 2}; }

inline Vec3 deviation(const OmniAngularOptions& options, Vec3) {
  return {{std::sqrt(options.alpha[0]), std::sqrt(options.alpha[1]), std::sqrt(options.alpha[2])}};
}

inline Vec3 follow(const OmniAngularOptions&, const Wish& wish) {
  const Vec2 body = unrotate(wish.velocity, wish.direction);
  return {{body.x, body.y, 0.0}};
}

}  // namespace irsim
