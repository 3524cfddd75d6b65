// An open polyline without thickness.
#pragma once

#include "shapes/polygon.hpp"

namespace irsim {

struct Linestring {
  Corners vertices;  // body frame [m]
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("vertices", &Linestring::vertices));
  }
};

inline Outline outline(const Linestring& l, const Draws&, std::uint64_t) {
  return {Kind::linestring, points(l.vertices)};
}

}  // namespace irsim
