// Where points, segments and rings lie relative to each other. Touching counts as meeting.
#pragma once

#include "geometry/vec.hpp"

namespace irsim {

/// Sign of the turn a -> b -> c. Near zero, error-free products make it exact but for the last bits.
inline double turn_of(Vec2 a, Vec2 b, Vec2 c) {
  const double left = (b.x - a.x) * (c.y - a.y), right = (b.y - a.y) * (c.x - a.x);
  const double det = left - right;
  if (std::fabs(det) > 4e-16 * (std::fabs(left) + std::fabs(right))) return det;
  if (left == right && left == 0.0) return 0.0;
  const double low_left = std::fma(b.x - a.x, c.y - a.y, -left);
  const double low_right = std::fma(b.y - a.y, c.x - a.x, -right);
  return det + (low_left - low_right);
}

/// Whether p, known to be on the line through a and b, lies between them.
inline bool between(Vec2 a, Vec2 b, Vec2 p) {
  return std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

/// Whether the closed segments ab and cd meet; if so, `where` is a common point.
inline bool segments_meet(Vec2 a, Vec2 b, Vec2 c, Vec2 d, Vec2& where) {
  const double c_side = turn_of(a, b, c), d_side = turn_of(a, b, d);
  if ((c_side > 0.0 && d_side > 0.0) || (c_side < 0.0 && d_side < 0.0)) return false;
  const double a_side = turn_of(c, d, a), b_side = turn_of(c, d, b);
  if ((a_side > 0.0 && b_side > 0.0) || (a_side < 0.0 && b_side < 0.0)) return false;
  if (c_side * d_side < 0.0 && a_side * b_side < 0.0) {
    where = a + (b - a) * (a_side / (a_side - b_side));
    return true;
  }
  if (c_side == 0.0 && between(a, b, c)) return where = c, true;
  if (d_side == 0.0 && between(a, b, d)) return where = d, true;
  if (a_side == 0.0 && between(c, d, a)) return where = a, true;
  if (b_side == 0.0 && between(c, d, b)) return where = b, true;
  return false;
}

/// The point of segment ab nearest to p.
inline Vec2 nearest_on_segment(Vec2 a, Vec2 b, Vec2 p) {
  const Vec2 along = b - a;
  const double length2 = squared(along);
  if (!(length2 > 0.0)) return a;
  return a + along * clip(dot(p - a, along) / length2, 0.0, 1.0);
}

/// Whether p lies inside a ring (even-odd rule); ring[count] repeats ring[0]. The result is arbitrary for points on the
/// ring.
inline bool inside_ring(const Vec2* ring, int count, Vec2 p) {
  bool inside = false;
  for (int i = 0; i < count; ++i) {
    const Vec2 a = ring[i], b = ring[i + 1];
    if ((a.y > p.y) != (b.y > p.y)) {
      const double side = turn_of(a, b, p);
      if (b.y > a.y ? side > 0.0 : side < 0.0) inside = !inside;
    }
  }
  return inside;
}

}  // namespace irsim
