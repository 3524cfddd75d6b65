// A disc.
#pragma once

#include "fields.hpp"
#include "geometry/shapes.hpp"

namespace irsim {

struct Circle {
  double radius;                 // [m]
  std::array<double, 2> center;  // body frame [m]
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("radius", &Circle::radius), field("center", &Circle::center));
  }
};

inline Outline outline(const Circle& c, const Draws&, std::uint64_t) {
  return {Kind::circle, {{c.center[0], c.center[1]}}, c.radius};
}

}  // namespace irsim
