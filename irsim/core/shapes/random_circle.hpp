// A disc whose radius is drawn for each scene.
#pragma once

#include "fields.hpp"
#include "geometry/shapes.hpp"

namespace irsim {

struct RandomCircle {
  std::array<double, 2> radius_range;  // [m]
  std::array<double, 2> center;        // body frame [m]
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("radius_range", &RandomCircle::radius_range), field("center", &RandomCircle::center));
  }
};

constexpr bool is_drawn(const RandomCircle&) { return true; }

inline Outline outline(const RandomCircle& c, const Draws& draws, std::uint64_t first) {
  return {Kind::circle, {{c.center[0], c.center[1]}}, draws.uniform(first, c.radius_range[0], c.radius_range[1])};
}

}  // namespace irsim
