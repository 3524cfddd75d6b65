// Shortest ways of a car between two poses without changing between forward and backward.
#pragma once

#include <array>

#include "geometry/vec.hpp"

namespace irsim {

/// Three pieces of a way: arcs of the turning circle, or straight.
struct DubinsWay {
  std::array<int, 3> bend{};       // 1 left, -1 right, 0 straight
  std::array<double, 3> length{};  // [m]
  double total() const { return length[0] + length[1] + length[2]; }
};

/// The six ways of which the shortest of all is one (Dubins: On curves of minimal length with a constraint on average
/// curvature, 1957; formulas of Shkel, Lumelsky: Classification of the Dubins set, 2001). `visit(way)` is called for
/// each that exists.
template <class Visit>
void for_dubins_ways(const Pose& from, const Pose& to, double radius, Visit&& visit) {
  const auto positive = [](double angle) {
    const double turned = wrap(angle);
    return turned < -1e-9 ? turned + kTurn : std::max(turned, 0.0);
  };
  const Vec2 gap = to.position() - from.position();
  const double d = norm(gap) / radius, direction = std::atan2(gap.y, gap.x);
  for (const double side : {1.0, -1.0}) {  // the second time mirrored: right turns for left turns
    const double a = side * (from.theta - direction), b = side * (to.theta - direction);
    const double sa = std::sin(a), ca = std::cos(a), sb = std::sin(b), cb = std::cos(b), c = std::cos(a - b);
    const int left = side > 0.0 ? 1 : -1;
    const auto offer = [&](int middle, int last, double t, double p, double q) {
      visit(DubinsWay{{left, middle, last}, {positive(t) * radius, p * radius, positive(q) * radius}});
    };
    const double same = 2.0 + d * d - 2.0 * c + 2.0 * d * (sa - sb);
    if (same >= 0.0) {
      const double along = std::atan2(cb - ca, d + sa - sb);
      offer(0, left, along - a, std::sqrt(same), b - along);
    }
    const double crossed = d * d - 2.0 + 2.0 * c + 2.0 * d * (sa + sb);
    if (crossed >= 0.0) {
      const double p = std::sqrt(crossed);
      const double along = std::atan2(-ca - cb, d + sa + sb) - std::atan2(-2.0, p);
      offer(0, -left, along - a, p, along - b);
    }
    const double cosine = (6.0 - d * d + 2.0 * c + 2.0 * d * (sb - sa)) / 8.0;
    if (std::fabs(cosine) <= 1.0) {
      const double p = kTurn - std::acos(cosine);
      const double t = positive(-a - std::atan2(ca - cb, d + sa - sb) + 0.5 * p);
      offer(-left, left, t, p, b - a - t + p);
    }
  }
}

/// The pose a distance along an arc or a straight piece; a negative distance is backward.
inline Pose along_bend(const Pose& from, int bend, double distance, double radius) {
  const double half = 0.5 * bend * distance / radius;
  const double chord = half == 0.0 ? distance : distance * std::sin(half) / half;
  return {from.x + chord * std::cos(from.theta + half), from.y + chord * std::sin(from.theta + half),
          wrap(from.theta + 2.0 * half)};
}

}  // namespace irsim
