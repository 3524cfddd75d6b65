// Differential drive: forward speed and yaw rate.
#pragma once

#include "drive.hpp"
#include "fields.hpp"

namespace irsim {

struct DiffOptions {
  bool noise;
  std::array<double, 4> alpha;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("noise", &DiffOptions::noise), field("alpha", &DiffOptions::alpha));
  }
};

inline void diff(const DiffOptions&, const Motion& m) { move(m, {m.control[0], 0.0}, m.control[1]); }

inline Rows rows(const DiffOptions&) { return {1, 1}; }

inline Vec3 deviation(const DiffOptions& options, Vec3 control) { return velocity_deviation(options.alpha, control); }

inline Vec3 follow(const DiffOptions&, const Wish& wish) {
  const ForwardWish forward = forward_wish(wish);
  return {{forward.speed, turn_rate(forward.error, wish.turning), 0.0}};
}

}  // namespace irsim
