#include "geometry/convex_hull.hpp"

#include <algorithm>

namespace irsim {

void make_hull(std::vector<Vec2>& points, std::vector<Vec2>& hull) {
  std::sort(points.begin(), points.end(), [](Vec2 a, Vec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  hull.clear();
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t first = hull.size();
    for (const Vec2 p : points) {
      while (hull.size() >= first + 2 && !(cross(hull.back() - hull[hull.size() - 2], p - hull.back()) > 0.0))
        hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  if (!hull.empty())
    points.swap(hull);
  else
    points.resize(1);
}

}  // namespace irsim
