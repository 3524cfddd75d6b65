#include "contact/triangulate.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "geometry/predicates.hpp"

namespace irsim {
namespace {

bool inside(Vec2 a, Vec2 b, Vec2 c, Vec2 p) {
  return turn_of(a, b, p) >= 0.0 && turn_of(b, c, p) >= 0.0 && turn_of(c, a, p) >= 0.0;
}

bool is_ear(const std::vector<Vec2>& ring, const std::vector<int>& left, std::size_t k) {
  const std::size_t n = left.size();
  const Vec2 a = ring[left[(k + n - 1) % n]], b = ring[left[k]], c = ring[left[(k + 1) % n]];
  if (!(turn_of(a, b, c) > 0.0)) return false;
  for (std::size_t j = 0; j < n; ++j) {
    if (j == k || j == (k + 1) % n || j == (k + n - 1) % n) continue;
    if (inside(a, b, c, ring[left[j]])) return false;
  }
  return true;
}

std::vector<Triangle> cut_ears(const std::vector<Vec2>& ring) {
  std::vector<int> left(ring.size());
  std::iota(left.begin(), left.end(), 0);
  std::vector<Triangle> out;
  while (left.size() > 3) {
    std::size_t ear = left.size();
    for (std::size_t k = 0; k < left.size() && ear == left.size(); ++k) {
      if (is_ear(ring, left, k)) ear = k;
    }
    const std::size_t n = left.size();
    if (ear == n) {  // the rest has no area or touches itself: cut the flattest corner
      ear = 0;
      double best = kInfinity;
      for (std::size_t k = 0; k < n; ++k) {
        const double turn = turn_of(ring[left[(k + n - 1) % n]], ring[left[k]], ring[left[(k + 1) % n]]);
        if (turn >= 0.0 && turn < best) best = turn, ear = k;
      }
    }
    const Triangle t = {left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]};
    if (turn_of(ring[t[0]], ring[t[1]], ring[t[2]]) > 0.0) out.push_back(t);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  if (left.size() == 3 && turn_of(ring[left[0]], ring[left[1]], ring[left[2]]) > 0.0) {
    out.push_back({left[0], left[1], left[2]});
  }
  return out;
}

/// Whether d lies inside the circle through a, b, c (counter-clockwise) by more than rounding errors.
bool in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const Vec2 u = a - d, v = b - d, w = c - d;
  const double uu = squared(u), vv = squared(v), ww = squared(w);
  const double determinant = uu * cross(v, w) - vv * cross(u, w) + ww * cross(u, v);
  const double size = std::max({uu, vv, ww});
  return determinant > 1e-12 * size * size;
}

}  // namespace

std::vector<Triangle> triangulate(const std::vector<Vec2>& ring) {
  std::vector<Triangle> out = cut_ears(ring);
  const int n = static_cast<int>(ring.size());
  std::map<std::pair<int, int>, int> beside;  // directed edge -> index of its triangle
  for (bool flipped = true; flipped;) {
    flipped = false;
    beside.clear();
    for (std::size_t t = 0; t < out.size(); ++t) {
      for (int k = 0; k < 3; ++k) beside[{out[t][k], out[t][(k + 1) % 3]}] = static_cast<int>(t);
    }
    for (std::size_t t = 0; t < out.size() && !flipped; ++t) {
      for (int k = 0; k < 3 && !flipped; ++k) {
        const int a = out[t][k], b = out[t][(k + 1) % 3], c = out[t][(k + 2) % 3];
        if ((a + 1) % n == b || (b + 1) % n == a) continue;
        const auto other = beside.find({b, a});
        if (other == beside.end()) continue;
        Triangle& s = out[other->second];
        const int d = s[0] + s[1] + s[2] - a - b;
        if (!in_circle(ring[a], ring[b], ring[c], ring[d])) continue;
        if (!(turn_of(ring[c], ring[a], ring[d]) > 0.0 && turn_of(ring[d], ring[b], ring[c]) > 0.0)) continue;
        s = {d, b, c};
        out[t] = {c, a, d};
        flipped = true;
      }
    }
  }
  return out;
}

}  // namespace irsim
