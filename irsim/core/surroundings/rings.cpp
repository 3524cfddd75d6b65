#include "surroundings/rings.hpp"

#include "geometry/convex_hull.hpp"
#include "geometry/predicates.hpp"

namespace irsim {
namespace {

constexpr double kSamePlace = 1e-9;       // corners this close are one [m]
constexpr double kTouching = 1.0 - 1e-6;  // at its full distance the tangent of a corner is a root of a rounding error
constexpr double kStraight = 1e-9;        // a smaller sine of a turn is a rounding error
constexpr double kMicrometres = 1e6;      // in a metre
constexpr double kSumError = 1e-13;       // relative; coordinates this close to a micrometre are meant to be there

bool goes_straight(Vec2 a, Vec2 b, Vec2 c) {
  const Vec2 in = b - a, out = c - b;
  return dot(in, out) > 0.0 && std::fabs(cross(in, out)) <= kStraight * norm(in) * norm(out);
}

/// A coordinate without the rounding errors of sums such as 10.1 + 0.25, which differ from one spelling to another.
double written(double x) {
  const double whole = std::round(x * kMicrometres) / kMicrometres;
  return std::fabs(x - whole) <= kSumError * (1.0 + std::fabs(x)) ? whole : x;
}

}  // namespace

std::vector<Vec2> bends_of(const Vec2* corners, int count) {
  std::vector<Vec2> distinct, bends;
  for (int k = 0; k < count; ++k) {
    const Vec2 corner{written(corners[k].x), written(corners[k].y)};
    if (distinct.empty() || norm(corner - distinct.back()) > kSamePlace) distinct.push_back(corner);
  }
  while (distinct.size() > 1 && norm(distinct.front() - distinct.back()) <= kSamePlace) distinct.pop_back();
  const std::size_t n = distinct.size();
  for (std::size_t k = 0; k < n; ++k)
    if (!goes_straight(distinct[(k + n - 1) % n], distinct[k], distinct[(k + 1) % n])) bends.push_back(distinct[k]);
  return bends;
}

Ring::Ring(const std::vector<Vec2>& outline, Inside side, int id) : object(id), inside(side), hull(outline) {
  std::vector<Vec2> scratch;
  make_hull(hull, scratch);
  for (const Vec2 p : outline) box_.include(p);
  if (inside != Inside::shell && inside != Inside::lining) return;
  corners = outline;
  corners.push_back(outline.front());
}

double Ring::distance(Vec2 p) const {
  const std::size_t n = hull.size();
  double least2 = kInfinity;
  for (std::size_t k = 0; k < n; ++k) {
    const Vec2 a = hull[k], b = hull[k + 1 < n ? k + 1 : 0];
    const double side = cross(b - a, p - a);
    if (side < 0.0 || n < 3) least2 = std::min(least2, squared(nearest_on_segment(a, b, p) - p));
  }
  return least2 < kInfinity ? std::sqrt(least2) : 0.0;
}

bool Ring::is_seen_from(Vec2 p) const {
  if (corners.empty()) return true;
  const bool boxed = p.x >= box_.x0 && p.x <= box_.x1 && p.y >= box_.y0 && p.y <= box_.y1;
  const bool within = boxed && inside_ring(corners.data(), static_cast<int>(corners.size()) - 1, p);
  return within == (inside == Inside::lining);
}

HullTangents Ring::tangents(Vec2 p, double distance, double radius) const {
  const double reach = std::min(radius, distance * kTouching);
  HullTangents found;
  bool first = true;
  for (const Vec2 corner : hull) {
    const Vec2 way = corner - p;
    const double far = norm(way), sine = std::min(1.0, reach / far), cosine = std::sqrt(1.0 - sine * sine);
    const Vec2 along = way * (1.0 / far), left = rotate(along, {cosine, sine}), right = rotate(along, {cosine, -sine});
    if (first || cross(found.left, left) > 0.0) found.left = left, found.left_corner = way;
    if (first || cross(found.right, right) < 0.0) found.right = right, found.right_corner = way;
    first = false;
  }
  return found;
}

double Ring::farthest(Vec2 p) const {
  double most2 = 0.0;
  for (const Vec2 corner : hull) most2 = std::max(most2, squared(corner - p));
  return std::sqrt(most2);
}

}  // namespace irsim
