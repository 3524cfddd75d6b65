#include "geometry/enclosing_circle.hpp"

namespace irsim {
namespace {

/// Distance by which `disc` extends beyond `circle`; negative inside.
double excess(const PlainDisc& circle, const PlainDisc& disc) {
  return norm(disc.centre - circle.centre) + disc.radius - circle.radius;
}

/// The smallest circle around two discs.
PlainDisc around(const PlainDisc& a, const PlainDisc& b) {
  const Vec2 d = b.centre - a.centre;
  const double length = norm(d);
  if (length + b.radius <= a.radius) return a;
  if (length + a.radius <= b.radius) return b;
  const double radius = 0.5 * (length + a.radius + b.radius);
  return {a.centre + d * ((radius - a.radius) / length), radius};
}

/// The circle around three discs that touches all of them (Apollonius); its radius is infinite if it does not exist.
PlainDisc around(const PlainDisc& a, const PlainDisc& b, const PlainDisc& c) {
  const PlainDisc none{{}, kInfinity};
  const Vec2 p = b.centre - a.centre, q = c.centre - a.centre;
  const double det = 2.0 * cross(p, q);
  if (det == 0.0) return none;
  // |x| = R - ra, |x - p| = R - rb, |x - q| = R - rc  ->  x = s + t R
  const double ra = a.radius;
  const double kp = squared(p) + ra * ra - b.radius * b.radius, kq = squared(q) + ra * ra - c.radius * c.radius;
  const double lp = 2.0 * (b.radius - ra), lq = 2.0 * (c.radius - ra);
  const Vec2 s{(kp * q.y - kq * p.y) / det, (kq * p.x - kp * q.x) / det};
  const Vec2 t{(lp * q.y - lq * p.y) / det, (lq * p.x - lp * q.x) / det};
  const double u = 1.0 - squared(t), v = ra + dot(s, t), w = ra * ra - squared(s);  // u R^2 - 2 v R + w = 0
  const double root = v * v - u * w;
  if (root < 0.0) return none;
  const double largest = std::max({a.radius, b.radius, c.radius});
  PlainDisc best = none;
  for (const double sign : {-1.0, 1.0}) {
    const double radius = u == 0.0 ? w / (2.0 * v) : (v + sign * std::sqrt(root)) / u;
    if (radius >= largest && radius < best.radius) best = {a.centre + s + t * radius, radius};
  }
  return best;
}

struct Basis {
  PlainDisc members[3];
  int count = 0;
  PlainDisc circle{{}, kInfinity};
};

/// The smallest circle around the basis and `extra` that `extra` determines, and the discs that determine it.
Basis extend(const Basis& basis, const PlainDisc& extra, double tolerance) {
  Basis best;
  const auto consider = [&](const PlainDisc& circle, std::initializer_list<int> kept) {
    if (!(circle.radius < best.circle.radius) || excess(circle, extra) > tolerance) return;
    for (int i = 0; i < basis.count; ++i)
      if (excess(circle, basis.members[i]) > tolerance) return;
    best.circle = circle;
    best.members[0] = extra;
    best.count = 1;
    for (const int i : kept) best.members[best.count++] = basis.members[i];
  };
  consider(extra, {});
  for (int i = 0; i < basis.count; ++i) {
    consider(around(extra, basis.members[i]), {i});
    for (int j = 0; j < i; ++j) consider(around(extra, basis.members[i], basis.members[j]), {i, j});
  }
  return best;
}

}  // namespace

PlainDisc enclosing_circle(const std::vector<PlainDisc>& discs) {
  if (discs.empty()) return {};
  Basis basis;
  basis.members[0] = basis.circle = discs.front();
  basis.count = 1;
  double scale = discs.front().radius;
  for (const PlainDisc& disc : discs) scale = std::max(scale, norm(disc.centre - discs.front().centre) + disc.radius);
  const double tolerance = 1e-13 * scale;
  for (std::size_t round = 0; round < 4 * discs.size() + 16;
       ++round) {  // the radius grows in each round; the limit ends the loop for NaN
    const PlainDisc* worst = nullptr;
    double most = tolerance;
    for (const PlainDisc& disc : discs) {
      const double e = excess(basis.circle, disc);
      if (e > most) most = e, worst = &disc;
    }
    if (worst == nullptr) break;
    const Basis next = extend(basis, *worst, 2.0 * tolerance);
    if (!(next.circle.radius > basis.circle.radius) || next.count == 0) break;
    basis = next;
  }
  return basis.circle;
}

}  // namespace irsim
