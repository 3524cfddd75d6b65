// A closed, filled, simple polygon.
#pragma once

#include "fields.hpp"
#include "geometry/shapes.hpp"

namespace irsim {

using Corners = std::vector<std::array<double, 2>>;

inline std::vector<Vec2> points(const Corners& corners) {
  std::vector<Vec2> out;
  for (const auto& c : corners) out.push_back({c[0], c[1]});
  if (out.empty()) out.push_back({});
  return out;
}

struct Polygon {
  Corners vertices;  // body frame [m]
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("vertices", &Polygon::vertices));
  }
};

inline Outline outline(const Polygon& p, const Draws&, std::uint64_t) { return {Kind::polygon, points(p.vertices)}; }

}  // namespace irsim
