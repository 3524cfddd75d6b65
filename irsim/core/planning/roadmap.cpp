#include "planning/roadmap.hpp"

#include <algorithm>

namespace irsim {
namespace {

constexpr int kMaxDrawsPerPoint = 100;  // largest number of draws per free point

struct Connection {
  int to;
  double length;
};

std::vector<Vec2> free_points(const Problem& problem, int count) {
  std::vector<Vec2> points;
  const Box& b = problem.space.bounds;
  const std::uint64_t most = static_cast<std::uint64_t>(count) * kMaxDrawsPerPoint;
  for (std::uint64_t k = 0; k < most && static_cast<int>(points.size()) < count; ++k) {
    const auto u = problem.draws.uniforms(problem.first_draw + k);
    const Vec2 p{b.x0 + (b.x1 - b.x0) * u[0], b.y0 + (b.y1 - b.y0) * u[1]};
    if (problem.space.free(p)) points.push_back(p);
  }
  return points;
}

}  // namespace

Plan search_roadmap(const Problem& problem, int samples, int neighbours, double longest) {
  Plan plan;
  if (!problem.space.free(problem.start) || !problem.space.free(problem.goal)) return plan;
  std::vector<Vec2> points = free_points(problem, samples);
  points.push_back(problem.start);
  points.push_back(problem.goal);
  const int count = static_cast<int>(points.size()), start = count - 2, goal = count - 1;
  std::vector<std::vector<Connection>> edges(points.size());
  std::vector<std::pair<double, int>> near;
  for (int i = 0; i < count; ++i) {
    near.clear();
    for (int k = 0; k < count; ++k) {
      const double d = norm(points[k] - points[i]);
      if (k != i && d < longest) near.emplace_back(d, k);
    }
    std::sort(near.begin(), near.end());
    int joined = 0;
    for (const auto& [length, k] : near) {
      if (joined >= neighbours) break;
      const auto known = [&](int from, int to) {
        return std::any_of(edges[from].begin(), edges[from].end(), [&](const Connection& e) { return e.to == to; });
      };
      if (!known(i, k)) {
        if (!problem.space.clear(points[i], points[k])) continue;
        edges[i].push_back({k, length});
        edges[k].push_back({i, length});
      }
      ++joined;
    }
  }
  std::vector<double> cost(points.size(), kInfinity);
  std::vector<int> parent(points.size(), -1);
  auto& heap = problem.memory.heap;
  heap.clear();
  std::uint32_t order = 0;
  cost[start] = 0.0;
  heap.push_back({0.0, order++, start});
  while (!heap.empty()) {
    std::pop_heap(heap.begin(), heap.end());
    const auto entry = heap.back();
    heap.pop_back();
    if (entry.key > cost[entry.node]) continue;
    if (entry.node == goal) break;
    for (const Connection& edge : edges[entry.node]) {
      const double through = entry.key + edge.length;
      if (!(through < cost[edge.to])) continue;
      cost[edge.to] = through;
      parent[edge.to] = entry.node;
      heap.push_back({through, order++, edge.to});
      std::push_heap(heap.begin(), heap.end());
    }
  }
  if (problem.explain) {
    plan.nodes = points;
    plan.parents = parent;
    plan.costs = cost;
  }
  if (!std::isfinite(cost[goal])) return plan;
  plan.cost = cost[goal];
  for (int k = goal; k >= 0; k = parent[k]) plan.path.push_back(points[k]);
  std::reverse(plan.path.begin(), plan.path.end());
  return plan;
}

}  // namespace irsim
