// Holonomic drive that keeps its heading: forward and lateral speed in the body frame.
#pragma once

#include "drive.hpp"
#include "fields.hpp"

namespace irsim {

struct OmniOptions {
  bool noise;
  std::array<double, 2> alpha;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("noise", &OmniOptions::noise), field("alpha", &OmniOptions::alpha));
  }
};

inline void omni(const OmniOptions&, const Motion& m) {
  const Vec2 wheels{m.control[0], m.control[1]};
  const Vec2 body = m.footing == nullptr ? wheels : wheels * (1.0 - m.footing->slip);
  translate(m, body, 0.0);
  add_unmoved(m, wheels, 0.0, body, 0.0, m.dt);
}

inline Rows rows(const OmniOptions&) { return {2, -1}; }

inline Vec3 deviation(const OmniOptions& options, Vec3) {
  return {{std::sqrt(options.alpha[0]), std::sqrt(options.alpha[1]), 0.0}};
}

inline Vec3 follow(const OmniOptions&, const Wish& wish) {
  const Vec2 body = unrotate(wish.velocity, wish.direction);
  return {{body.x, body.y, 0.0}};
}

}  // namespace irsim
