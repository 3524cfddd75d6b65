#include "planning/tree.hpp"

#include <algorithm>

namespace irsim {
namespace {

constexpr std::uint64_t kDrawsPerSample = 16;  // blocks of draws per sample, to find one within the world

struct Node {
  Vec2 p;
  int parent;
  double cost;
  std::vector<int> children;
};

class Tree {
 public:
  Tree(const Problem& problem, const TreeOptions& options) : problem_(problem), options_(options) {}

  Plan grow() {
    Plan plan;
    if (!problem_.space.free(problem_.start) || !problem_.space.free(problem_.goal)) return plan;
    nodes_.push_back({problem_.start, -1, 0.0, {}});
    try_goal(0);
    for (int k = 0; k < options_.max_iter; ++k) {
      if (last_ >= 0 && !options_.search_until_max_iter) break;
      const Vec2 target = sample(problem_.first_draw + kDrawsPerSample * static_cast<std::uint64_t>(k));
      const int from = nearest(target);
      const Vec2 p = steer(nodes_[from].p, target);
      if (!(norm(p - nodes_[from].p) > 0.0) || !problem_.space.clear(nodes_[from].p, p)) continue;
      add(from, p);
      try_goal(static_cast<int>(nodes_.size()) - 1);
    }
    if (problem_.explain) {
      for (const Node& node : nodes_) {
        plan.nodes.push_back(node.p);
        plan.parents.push_back(node.parent);
        plan.costs.push_back(node.cost);
      }
    }
    if (last_ < 0) return plan;
    choose_end();
    plan.cost = end_cost();
    plan.path.push_back(problem_.goal);
    for (int k = last_; k >= 0; k = nodes_[k].parent) {
      if (norm(nodes_[k].p - plan.path.back()) > 0.0) plan.path.push_back(nodes_[k].p);
    }
    if (plan.path.size() == 1) plan.path.push_back(problem_.start);
    std::reverse(plan.path.begin(), plan.path.end());
    return plan;
  }

 private:
  Vec2 sample(std::uint64_t block) const {
    const auto u = problem_.draws.uniforms(block);
    const Box& b = problem_.space.bounds;
    if (100.0 * u[0] < options_.goal_sample_rate) return problem_.goal;
    if (!options_.informed || last_ < 0) return {b.x0 + (b.x1 - b.x0) * u[1], b.y0 + (b.y1 - b.y0) * u[2]};
    // The ellipse of points through which paths from start to goal are no longer than the best path so far.
    const Vec2 along = problem_.goal - problem_.start;
    const double least = norm(along), most = std::max(end_cost(), least);
    const double a = 0.5 * most, c = 0.5 * std::sqrt(std::max(0.0, most * most - least * least));
    const Vec2 direction = least > 0.0 ? along * (1.0 / least) : Vec2{1.0, 0.0};
    Vec2 p;
    for (std::uint64_t k = 0; k < kDrawsPerSample; ++k) {
      const auto v = problem_.draws.uniforms(block + k);
      const Vec2 disc = unit(kTurn * v[2]) * std::sqrt(v[1]);
      p = (problem_.start + problem_.goal) * 0.5 + rotate({a * disc.x, c * disc.y}, direction);
      if (p.x >= b.x0 && p.x <= b.x1 && p.y >= b.y0 && p.y <= b.y1) break;
    }
    return {clip(p.x, b.x0, b.x1), clip(p.y, b.y0, b.y1)};
  }

  int nearest(Vec2 p) const {
    int best = 0;
    double least = kInfinity;
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      const double d = squared(nodes_[k].p - p);
      if (d < least) least = d, best = static_cast<int>(k);
    }
    return best;
  }

  Vec2 steer(Vec2 from, Vec2 to) const {
    const double distance = norm(to - from);
    double length = std::min(distance, options_.expand_dis);
    const double steps = std::floor(length / options_.path_resolution + 1e-9);
    if (distance - steps * options_.path_resolution > options_.path_resolution && steps >= 1.0)
      length = steps * options_.path_resolution;
    return length >= distance ? to : from + (to - from) * (length / distance);
  }

  void add(int from, Vec2 p) {
    const int self = static_cast<int>(nodes_.size());
    near_.clear();
    if (options_.rewire) {
      const double n = static_cast<double>(nodes_.size()) + 1.0;
      const double radius = std::min(options_.connect_circle_dist * std::sqrt(std::log(n) / n), options_.expand_dis);
      for (int k = 0; k < self; ++k) {
        if (squared(nodes_[k].p - p) <= radius * radius) near_.push_back(k);
      }
    }
    double cost = nodes_[from].cost + norm(p - nodes_[from].p);
    for (const int k : near_) {
      const double through = nodes_[k].cost + norm(p - nodes_[k].p);
      if (through < cost && problem_.space.clear(nodes_[k].p, p)) cost = through, from = k;
    }
    nodes_.push_back({p, from, cost, {}});
    nodes_[from].children.push_back(self);
    for (const int k : near_) {
      const double through = cost + norm(nodes_[k].p - p);
      if (through < nodes_[k].cost && problem_.space.clear(p, nodes_[k].p)) adopt(self, k, through);
    }
  }

  void adopt(int parent, int child, double cost) {
    std::vector<int>& siblings = nodes_[nodes_[child].parent].children;
    siblings.erase(std::find(siblings.begin(), siblings.end(), child));
    nodes_[child].parent = parent;
    nodes_[parent].children.push_back(child);
    const double change = cost - nodes_[child].cost;
    std::vector<int> left = {child};
    while (!left.empty()) {
      Node& node = nodes_[left.back()];
      left.pop_back();
      node.cost += change;
      left.insert(left.end(), node.children.begin(), node.children.end());
    }
  }

  void try_goal(int node) {
    const double distance = norm(problem_.goal - nodes_[node].p);
    if (distance > options_.expand_dis) return;
    if (last_ >= 0 && nodes_[node].cost + distance >= end_cost()) return;
    if (!problem_.space.clear(nodes_[node].p, problem_.goal)) return;
    last_ = node;
    if (options_.rewire) ends_.push_back(node);
  }
  /// Choose the best end again, because rewiring has changed costs.
  void choose_end() {
    for (const int k : ends_) {
      if (nodes_[k].cost + norm(problem_.goal - nodes_[k].p) < end_cost()) last_ = k;
    }
  }
  double end_cost() const { return nodes_[last_].cost + norm(problem_.goal - nodes_[last_].p); }

  const Problem& problem_;
  const TreeOptions& options_;
  std::vector<Node> nodes_;
  std::vector<int> near_, ends_;  // ends: nodes with a free line to the goal
  int last_ = -1;                 // the best end so far, -1 without one
};

}  // namespace

Plan grow_tree(const Problem& problem, const TreeOptions& options) { return Tree(problem, options).grow(); }

}  // namespace irsim
