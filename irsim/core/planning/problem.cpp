#include "planning/problem.hpp"

namespace irsim {

double path_length(const std::vector<Vec2>& path) {
  double sum = 0.0;
  for (std::size_t k = 1; k < path.size(); ++k) sum += norm(path[k] - path[k - 1]);
  return sum;
}

void shorten(const Space& space, std::vector<Vec2>& path) {
  if (path.size() < 3) return;
  // Points on straight runs are removed first, because most points of a path on a grid are such points.
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
      // Search by doubling and then halving steps for the farthest corner in sight.
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
    // Points in the middle of edges let the next pass cut corners.
    std::vector<Vec2> finer = {corners.front()};
    for (std::size_t k = 1; k < corners.size(); ++k) {
      if (corners.size() > 2) finer.push_back((corners[k - 1] + corners[k]) * 0.5);
      finer.push_back(corners[k]);
    }
    corners = std::move(finer);
  }
  // Remove added points that are not corners.
  path = {corners.front()};
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    const Vec2 before = corners[k] - path.back(), after = corners[k + 1] - corners[k];
    if (std::fabs(cross(before, after)) > 1e-9 * norm(before) * norm(after)) path.push_back(corners[k]);
  }
  path.push_back(corners.back());
}

}  // namespace irsim
