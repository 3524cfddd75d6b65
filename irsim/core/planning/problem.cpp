#include "planning/problem.hpp"

namespace irsim {

double path_length(const std::vector<Vec2>& path) {
  double sum = 0.0;
  for (std::size_t k = 1; k < path.size(); ++k) sum += norm(path[k] - path[k - 1]);
  return sum;
}

void shorten(const Space& space, std::vector<Vec2>& path) {
  if (path.size() < 3) return;
  // points on straight runs first: they are what most of a path on a grid is made of
  std::vector<Vec2> corners = {path.front()};
  for (std::size_t k = 1; k + 1 < path.size(); ++k) {
    const Vec2 before = path[k] - corners.back(), after = path[k + 1] - path[k];
    const bool straight =
        std::fabs(cross(before, after)) <= 1e-9 * norm(before) * norm(after) && dot(before, after) > 0;
    if (!straight) corners.push_back(path[k]);
  }
  corners.push_back(path.back());
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<Vec2> kept = {corners.front()};
    std::size_t from = 0;
    while (from + 1 < corners.size()) {
      // doubling steps, then back: the farthest corner in a row that is in sight
      std::size_t to = from + 1, step = 1;
      while (to + step < corners.size() && space.clear(corners[from], corners[to + step])) to += step, step *= 2;
      for (; step > 0; step /= 2) {
        if (to + step < corners.size() && space.clear(corners[from], corners[to + step])) to += step;
      }
      kept.push_back(corners[to]);
      from = to;
    }
    if (kept.size() == corners.size()) {
      corners = std::move(kept);
      break;
    }
    corners = std::move(kept);
    if (pass == 2) break;
    // a point in the middle of long edges lets the next pass cut corners
    std::vector<Vec2> finer = {corners.front()};
    for (std::size_t k = 1; k < corners.size(); ++k) {
      if (corners.size() > 2) finer.push_back((corners[k - 1] + corners[k]) * 0.5);
      finer.push_back(corners[k]);
    }
    corners = std::move(finer);
  }
  // the points put in that are of no use
  path = {corners.front()};
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    const Vec2 before = corners[k] - path.back(), after = corners[k + 1] - corners[k];
    if (std::fabs(cross(before, after)) > 1e-9 * norm(before) * norm(after)) path.push_back(corners[k]);
  }
  path.push_back(corners.back());
}

}  // namespace irsim
