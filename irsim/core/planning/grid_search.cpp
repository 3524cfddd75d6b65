#include "planning/grid_search.hpp"

#include <algorithm>

namespace irsim {
namespace {

constexpr double kDefaultResolution = 0.1;  // cell size without a map [m]
// Factor that breaks ties in favor of nodes nearer to the goal. Costs of different numbers of steps differ by far more,
// so the path is still the shortest.
constexpr double kPreference = 1.0 + 1e-9;

struct Step {
  int dx, dy;
};
constexpr Step kSteps[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}};

/// The state of a search on one lattice.
class Search {
 public:
  Search(const Problem& problem, double resolution)
      : problem_(problem),
        lattice_(lattice_for(problem, resolution)),
        cells_(lattice_, problem.space, problem.memory.open),
        memory_(problem.memory),
        diagonal_(norm(lattice_.cell)) {}

  template <class Expand>
  Plan run(bool start_must_be_open, Expand&& expand) {
    Plan plan;
    const int start = ends(problem_.start, start_must_be_open), goal = ends(problem_.goal, true);
    if (start < 0 || goal < 0) return plan;
    goal_i_ = goal % lattice_.nx, goal_j_ = goal / lattice_.nx;
    const std::size_t nodes = static_cast<std::size_t>(lattice_.nodes());
    memory_.cost.assign(nodes, kInfinity);
    memory_.parent.assign(nodes, -1);
    memory_.closed.assign(nodes, 0);
    memory_.heap.clear();
    order_ = 0;
    reach(start, -1, 0.0);
    while (!memory_.heap.empty()) {
      std::pop_heap(memory_.heap.begin(), memory_.heap.end());
      const int node = memory_.heap.back().node;
      memory_.heap.pop_back();
      if (memory_.closed[node]) continue;
      memory_.closed[node] = 1;
      if (problem_.explain) note(plan, node);
      if (node == goal) {
        finish(plan, goal);
        return plan;
      }
      expand(*this, node % lattice_.nx, node / lattice_.nx);
    }
    return plan;
  }

  bool open(int i, int j) { return cells_.open(i, j); }
  bool is_goal(int i, int j) const { return i == goal_i_ && j == goal_j_; }
  int parent(int i, int j) const { return memory_.parent[lattice_.node(i, j)]; }
  const Lattice& lattice() const { return lattice_; }

  /// The cost of a straight or diagonal move, or of the shortest path without obstacles.
  double distance(int di, int dj) const {
    di = std::abs(di), dj = std::abs(dj);
    const int both = std::min(di, dj);
    return both * diagonal_ + (di - both) * lattice_.cell.x + (dj - both) * lattice_.cell.y;
  }
  /// Offer the move from (i, j) to another cell in straight or diagonal direction.
  void offer(int i, int j, int to_i, int to_j) {
    const int node = lattice_.node(i, j);
    reach(lattice_.node(to_i, to_j), node, memory_.cost[node] + distance(to_i - i, to_j - j));
  }

 private:
  void reach(int node, int from, double cost) {
    if (memory_.closed[node] || !(cost < memory_.cost[node])) return;
    memory_.cost[node] = cost;
    memory_.parent[node] = from;
    const double left = distance(goal_i_ - node % lattice_.nx, goal_j_ - node / lattice_.nx);
    memory_.heap.push_back({cost + left * kPreference, order_++, node});
    std::push_heap(memory_.heap.begin(), memory_.heap.end());
  }

  /// The node at which a search begins or ends; -1 without such a node.
  int ends(Vec2 p, bool must_be_open) {
    const int i = lattice_.column(p.x), j = lattice_.row(p.y);
    if (problem_.tight == nullptr) return !must_be_open || cells_.open(i, j) ? lattice_.node(i, j) : -1;
    // The nearest open node that the body can reach in a straight line.
    const int most = 3 + static_cast<int>(problem_.space.body.reach() / std::min(lattice_.cell.x, lattice_.cell.y));
    int best = -1;
    double least = kInfinity;
    for (int ring = 0; ring <= most && best < 0; ++ring) {
      for (int dj = -ring; dj <= ring; ++dj) {
        for (int di = -ring; di <= ring; ++di) {
          if (std::max(std::abs(di), std::abs(dj)) != ring || !cells_.open(i + di, j + dj)) continue;
          const Vec2 node = lattice_.at(i + di, j + dj);
          if (norm(node - p) >= least || !problem_.tight->clear(node, p)) continue;
          least = norm(node - p);
          best = lattice_.node(i + di, j + dj);
        }
      }
    }
    return best;
  }

  void note(Plan& plan, int node) {
    plan.nodes.push_back(lattice_.at(node));
    plan.parents.push_back(-1);
    plan.costs.push_back(memory_.cost[node]);
  }

  void finish(Plan& plan, int goal) {
    plan.cost = memory_.cost[goal];
    for (int node = goal; node >= 0; node = memory_.parent[node]) {
      const int from = memory_.parent[node];
      int i = node % lattice_.nx, j = node / lattice_.nx;
      plan.path.push_back(lattice_.at(i, j));
      if (from < 0) break;
      // The cells of a jump are filled in.
      const int to_i = from % lattice_.nx, to_j = from / lattice_.nx;
      const int dx = (to_i > i) - (to_i < i), dy = (to_j > j) - (to_j < j);
      for (i += dx, j += dy; i != to_i || j != to_j; i += dx, j += dy) plan.path.push_back(lattice_.at(i, j));
    }
    std::reverse(plan.path.begin(), plan.path.end());
    if (problem_.tight == nullptr) return;
    plan.path.insert(plan.path.begin(), problem_.start);
    plan.path.push_back(problem_.goal);
    plan.cost = path_length(plan.path);
  }

  const Problem& problem_;
  Lattice lattice_;
  OpenCells cells_;
  SearchMemory& memory_;
  double diagonal_;
  int goal_i_ = 0, goal_j_ = 0;
  std::uint32_t order_ = 0;
};

/// Jumps over cells that need no decision.
struct Jumps {
  Search& search;

  /// Move (i, j) to the next jump point in a straight direction. Returns false without such a point.
  bool straight(int& i, int& j, int dx, int dy) const {
    while (true) {
      i += dx, j += dy;
      if (!search.open(i, j)) return false;
      if (search.is_goal(i, j)) return true;
      for (const int side : {1, -1}) {
        // A forced neighbor: the shortest path to it leads through this cell.
        const int si = dy * side, sj = dx * side;
        if (!search.open(i - dx + si, j - dy + sj) && search.open(i + si, j + sj)) return true;
      }
    }
  }
  bool diagonal(int& i, int& j, int dx, int dy) const {
    while (true) {
      if (!search.open(i + dx, j) || !search.open(i, j + dy) || !search.open(i + dx, j + dy)) return false;
      i += dx, j += dy;
      if (search.is_goal(i, j)) return true;
      int ai = i, aj = j, bi = i, bj = j;
      if (straight(ai, aj, dx, 0) || straight(bi, bj, 0, dy)) return true;
    }
  }
  void offer(int i, int j, int dx, int dy) const {
    int to_i = i, to_j = j;
    if (dx != 0 && dy != 0 ? diagonal(to_i, to_j, dx, dy) : straight(to_i, to_j, dx, dy))
      search.offer(i, j, to_i, to_j);
  }
};

void expand_jumps(Search& search, int i, int j) {
  const Jumps jumps{search};
  const int from = search.parent(i, j);
  if (from < 0) {
    for (const Step& s : kSteps) jumps.offer(i, j, s.dx, s.dy);
    return;
  }
  const int nx = search.lattice().nx, fi = from % nx, fj = from / nx;
  const int dx = (i > fi) - (i < fi), dy = (j > fj) - (j < fj);
  if (dx != 0 && dy != 0) {
    jumps.offer(i, j, dx, 0);
    jumps.offer(i, j, 0, dy);
    jumps.offer(i, j, dx, dy);
    return;
  }
  jumps.offer(i, j, dx, dy);
  for (const int side : {1, -1}) {
    const int si = dy * side, sj = dx * side;
    if (search.open(i - dx + si, j - dy + sj) || !search.open(i + si, j + sj)) continue;
    jumps.offer(i, j, si, sj);
    jumps.offer(i, j, dx + si, dy + sj);
  }
}

}  // namespace

Lattice lattice_for(const Problem& problem, double resolution) {
  if (resolution <= 0.0 && problem.own != nullptr) return *problem.own;
  return Lattice::over(problem.space.bounds, resolution > 0.0 ? resolution : kDefaultResolution);
}

Plan search_astar(const Problem& problem, double resolution) {
  return Search(problem, resolution).run(false, [](Search& search, int i, int j) {
    bool beside[4];
    for (int k = 0; k < 4; ++k) {
      beside[k] = search.open(i + kSteps[k].dx, j + kSteps[k].dy);
      if (beside[k]) search.offer(i, j, i + kSteps[k].dx, j + kSteps[k].dy);
    }
    for (int k = 0; k < 4; ++k) {
      const Step& s = kSteps[4 + k];
      if (beside[k] && beside[(k + 1) % 4] && search.open(i + s.dx, j + s.dy)) search.offer(i, j, i + s.dx, j + s.dy);
    }
  });
}

Plan search_jumps(const Problem& problem, double resolution) {
  return Search(problem, resolution).run(true, expand_jumps);
}

}  // namespace irsim
