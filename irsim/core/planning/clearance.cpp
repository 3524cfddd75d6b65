#include "planning/clearance.hpp"

#include <algorithm>
#include <numeric>

namespace irsim {
namespace {

constexpr double kDiagonal = 0.70710678118654752;  // half the diagonal of a unit square
constexpr float kTouching = 1e-6f;                 // smaller distances count as 0 [m]

struct Move {
  int dx, dy;
};
constexpr Move kMoves[] = {{-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}};

/// Clip a segment to a box. Returns false if no part of it is inside.
bool clip_to_box(Vec2& a, Vec2& b, const Box& box) {
  double t0 = 0.0, t1 = 1.0;
  const Vec2 d = b - a;
  const double p[] = {-d.x, d.x, -d.y, d.y}, q[] = {a.x - box.x0, box.x1 - a.x, a.y - box.y0, box.y1 - a.y};
  for (int k = 0; k < 4; ++k) {
    if (p[k] == 0.0) {
      if (q[k] < 0.0) return false;
    } else if (p[k] < 0.0) {
      t0 = std::max(t0, q[k] / p[k]);
    } else {
      t1 = std::min(t1, q[k] / p[k]);
    }
  }
  if (!(t0 <= t1)) return false;
  const Vec2 start = a;
  a = start + d * t0, b = start + d * t1;
  return true;
}

}  // namespace

template <class Visit>
void Clearance::around(int node, Visit&& visit) const {
  const int i = node % lattice_.nx, j = node / lattice_.nx;
  for (const Move& step : kMoves) {
    if (lattice_.holds(i + step.dx, j + step.dy)) visit(lattice_.node(i + step.dx, j + step.dy));
  }
}

Clearance::Clearance(const Blockers& blockers, const Lattice& lattice) : lattice_(lattice) {
  const std::size_t nodes = static_cast<std::size_t>(lattice.nodes());
  area_ = {lattice.origin.x, lattice.origin.y, lattice.origin.x + lattice.nx * lattice.cell.x,
           lattice.origin.y + lattice.ny * lattice.cell.y};
  nearest_.assign(nodes, -1);
  solid_.assign(nodes, 0);
  distance_.assign(nodes, std::numeric_limits<float>::infinity());
  for (int id = 0; id < blockers.shapes.objects(); ++id) {
    if (!blockers.counts(id)) continue;
    const Footprint body = blockers.outlines.footprint(blockers.shapes, id);
    for (int k = 0; k < body.count; ++k) add(body.parts[k], body.vertices);
  }
  spread_features();
  for (std::size_t n = 0; n < nodes; ++n) {
    if (solid_[n] || distance_[n] < kTouching) distance_[n] = 0.0f;
  }
  join_nodes();
}

void Clearance::add(const Part& part, const Vec2* vertices) {
  if (part.cells != nullptr) return add_cells(*part.cells);
  if (part.kind == Kind::circle) return add_circle(vertices[part.first], part.radius);
  for (int k = part.first; k < part.last; ++k) add_edge(vertices[k], vertices[k + 1]);
  if (is_closed(part.kind)) fill(vertices + part.first, part.last - part.first, part.kind == Kind::room);
}

void Clearance::add_cells(const OccupancyGrid& grid) {
  for (const std::vector<Vec2>& ring : grid.outline()) {
    for (std::size_t k = 0; k < ring.size(); ++k) add_edge(ring[k], ring[(k + 1) % ring.size()]);
  }
  for (int j = 0; j < lattice_.ny; ++j) {
    for (int i = 0; i < lattice_.nx; ++i) {
      const Vec2 p = lattice_.at(i, j);
      const int column = static_cast<int>(std::floor((p.x - grid.origin().x) / grid.cell().x));
      const int row = static_cast<int>(std::floor((p.y - grid.origin().y) / grid.cell().y));
      if (grid.occupied(column, row)) solid_[lattice_.node(i, j)] = 1;
    }
  }
}

void Clearance::add_edge(Vec2 a, Vec2 b) {
  const int feature = static_cast<int>(features_.size());
  features_.push_back({a, b, -1.0});
  if (!clip_to_box(a, b, area_)) return;
  // Every cell on the way: the columns of the segment, and in each column the rows that it passes.
  if (a.x > b.x) std::swap(a, b);
  const int first = lattice_.column(a.x), last = lattice_.column(b.x);
  const double slope = b.x > a.x ? (b.y - a.y) / (b.x - a.x) : 0.0;
  for (int i = first; i <= last; ++i) {
    const double left = std::max(a.x, lattice_.origin.x + i * lattice_.cell.x);
    const double right = std::min(b.x, lattice_.origin.x + (i + 1) * lattice_.cell.x);
    double low = first == last ? a.y : a.y + slope * (left - a.x),
           high = first == last ? b.y : a.y + slope * (right - a.x);
    if (low > high) std::swap(low, high);
    for (int j = lattice_.row(low); j <= lattice_.row(high); ++j) offer_around(lattice_.node(i, j), feature);
  }
}

void Clearance::add_circle(Vec2 centre, double radius) {
  const int feature = static_cast<int>(features_.size());
  features_.push_back({centre, centre, radius});
  const Box box = box_around(centre, radius);
  if (!box.meets(area_)) return;
  const double half = kDiagonal * std::max(lattice_.cell.x, lattice_.cell.y);
  const int i0 = lattice_.column(box.x0), i1 = lattice_.column(box.x1);
  for (int i = i0; i <= i1; ++i) {
    const double dx = lattice_.at(i, 0).x - centre.x, reach = radius + half;
    const double dy = std::sqrt(std::max(0.0, reach * reach - dx * dx));
    const int j0 = lattice_.row(centre.y - dy), j1 = lattice_.row(centre.y + dy);
    for (int j = j0; j <= j1; ++j) {
      const int node = lattice_.node(i, j);
      const double away = norm(lattice_.at(i, j) - centre) - radius;
      if (away <= 0.0) solid_[node] = 1;
      if (std::fabs(away) <= half) offer_around(node, feature);
    }
  }
}

void Clearance::fill(const Vec2* vertices, int edges, bool outside) {
  std::vector<double> crossings;
  for (int j = 0; j < lattice_.ny; ++j) {
    const double y = lattice_.at(0, j).y;
    crossings.clear();
    for (int k = 0; k < edges; ++k) {
      const Vec2 a = vertices[k], b = vertices[k + 1];
      if ((a.y > y) != (b.y > y)) crossings.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
    }
    if (crossings.empty() && !outside) continue;
    std::sort(crossings.begin(), crossings.end());
    std::size_t passed = 0;
    int i = 0;
    if (!outside) i = lattice_.column(crossings.front());
    for (; i < lattice_.nx; ++i) {
      const double x = lattice_.at(i, j).x;
      while (passed < crossings.size() && crossings[passed] < x) ++passed;
      if (!outside && passed == crossings.size()) break;
      if ((passed % 2 == 1) != outside) solid_[lattice_.node(i, j)] = 1;
    }
  }
}

double Clearance::distance_to(const Feature& feature, Vec2 p) const {
  if (feature.radius >= 0.0) return std::fabs(norm(p - feature.a) - feature.radius);
  const Vec2 d = feature.b - feature.a;
  const double length = squared(d);
  const double t = length > 0.0 ? clip(dot(p - feature.a, d) / length, 0.0, 1.0) : 0.0;
  return norm(p - (feature.a + d * t));
}

void Clearance::offer(int node, int feature) {
  const float d = static_cast<float>(distance_to(features_[feature], lattice_.at(node)));
  if (d < distance_[node]) distance_[node] = d, nearest_[node] = feature;
}

void Clearance::offer_around(int node, int feature) {
  offer(node, feature);
  around(node, [&](int other) { offer(other, feature); });
}

void Clearance::spread_features() {
  const int nx = lattice_.nx, ny = lattice_.ny;
  const auto ask = [&](int i, int j, int di, int dj) {
    if (!lattice_.holds(i + di, j + dj)) return;
    const int other = nearest_[lattice_.node(i + di, j + dj)], node = lattice_.node(i, j);
    if (other >= 0 && other != nearest_[node]) offer(node, other);
  };
  for (int pass = 0; pass < 2; ++pass) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) ask(i, j, -1, -1), ask(i, j, 0, -1), ask(i, j, 1, -1), ask(i, j, -1, 0);
      for (int i = nx - 1; i >= 0; --i) ask(i, j, 1, 0);
    }
    for (int j = ny - 1; j >= 0; --j) {
      for (int i = nx - 1; i >= 0; --i) ask(i, j, 1, 1), ask(i, j, 0, 1), ask(i, j, -1, 1), ask(i, j, 1, 0);
      for (int i = 0; i < nx; ++i) ask(i, j, -1, 0);
    }
  }
}

void Clearance::join_nodes() {
  const std::size_t nodes = distance_.size();
  parent_.resize(nodes), saddle_.assign(nodes, -1), joined_.assign(nodes, 0);
  std::iota(parent_.begin(), parent_.end(), 0);
  std::vector<std::int32_t> order;
  for (std::size_t n = 0; n < nodes; ++n) {
    if (distance_[n] > 0.0f) order.push_back(static_cast<std::int32_t>(n));
  }
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return distance_[a] > distance_[b] || (distance_[a] == distance_[b] && a < b);
  });
  std::vector<std::int32_t> root(nodes, -1),
      count(nodes, 1);  // root: parents with path compression, -1 for nodes not reached yet
  const auto find = [&](std::int32_t n) {
    while (root[n] != n) n = root[n] = root[root[n]];
    return n;
  };
  std::uint32_t time = 0;
  for (const std::int32_t n : order) {
    root[n] = n;
    around(n, [&](int other) {
      if (root[other] < 0) return;
      std::int32_t a = find(n), b = find(other);
      if (a == b) return;
      if (count[a] < count[b]) std::swap(a, b);
      root[b] = parent_[b] = a;
      count[a] += count[b];
      saddle_[b] = n;
      joined_[b] = ++time;
    });
  }
}

Clearance::Way Clearance::widest(int a, int b) const {
  if (distance_[a] <= 0.0f || distance_[b] <= 0.0f) return {-kInfinity, -1};
  int node = distance_[a] < distance_[b] ? a : b;
  std::uint32_t last = 0;
  while (a != b) {  // climb from the node with the earlier join, since joins come later toward the root
    const bool up_a = joined_[a] != 0 && (joined_[b] == 0 || joined_[a] < joined_[b]);
    int& lower = up_a ? a : b;
    if (joined_[lower] == 0) return {-kInfinity, -1};
    if (joined_[lower] > last) last = joined_[lower], node = saddle_[lower];
    lower = parent_[lower];
  }
  return {distance_[node], node};
}

Clearance::Way Clearance::widest(Vec2 from, Vec2 to, double reach) const {
  const auto within = [&](Vec2 p, double d) {
    std::vector<int> found;
    const int i0 = lattice_.column(p.x - d), i1 = lattice_.column(p.x + d);
    const int j0 = lattice_.row(p.y - d), j1 = lattice_.row(p.y + d);
    for (int j = j0; j <= j1; ++j) {
      for (int i = i0; i <= i1; ++i) {
        if (norm(lattice_.at(i, j) - p) <= d) found.push_back(lattice_.node(i, j));
      }
    }
    if (found.empty()) found.push_back(lattice_.nearest(p));
    return found;
  };
  const double half = kDiagonal * std::max(lattice_.cell.x, lattice_.cell.y);
  Way best{-kInfinity, -1};
  const std::vector<int> ends = within(to, std::max(reach, half));
  for (const int a : within(from, half)) {
    for (const int b : ends) {
      const Way way = widest(a, b);
      if (way.room > best.room) best = way;
    }
  }
  return best;
}

Vec2 Clearance::climb(Vec2 from, double reach) const {
  int node = lattice_.nearest(from);
  while (true) {
    int best = node;
    around(node, [&](int other) {
      if (distance_[other] > distance_[best] && norm(lattice_.at(other) - from) <= reach) best = other;
    });
    if (best == node) return lattice_.at(node);
    node = best;
  }
}

std::vector<Vec2> Clearance::way(Vec2 from, Vec2 to, double room) const {
  struct Entry {
    double key, cost;
    int node;
    bool operator<(const Entry& other) const { return key > other.key || (key == other.key && node > other.node); }
  };
  const int start = lattice_.nearest(from), goal = lattice_.nearest(to);
  const std::size_t nodes = distance_.size();
  std::vector<double> cost(nodes, kInfinity);
  std::vector<std::int32_t> before(nodes, -1);
  std::vector<Entry> heap;
  const Vec2 end = lattice_.at(goal);
  const auto left = [&](int node) {
    const Vec2 d = lattice_.at(node) - end;
    const double nx = std::fabs(d.x) / lattice_.cell.x, ny = std::fabs(d.y) / lattice_.cell.y, both = std::min(nx, ny);
    return both * norm(lattice_.cell) + (nx - both) * lattice_.cell.x + (ny - both) * lattice_.cell.y;
  };
  const auto reached = [&](int node, int from_node, double c) {
    if (!(c < cost[node])) return;
    cost[node] = c, before[node] = from_node;
    heap.push_back({c + left(node), c, node});
    std::push_heap(heap.begin(), heap.end());
  };
  reached(start, -1, 0.0);
  std::vector<Vec2> path;
  while (!heap.empty()) {
    std::pop_heap(heap.begin(), heap.end());
    const Entry entry = heap.back();
    heap.pop_back();
    if (entry.cost > cost[entry.node]) continue;
    if (entry.node == goal) {
      for (int n = goal; n >= 0; n = before[n]) path.push_back(lattice_.at(n));
      std::reverse(path.begin(), path.end());
      return path;
    }
    const Vec2 here = lattice_.at(entry.node);
    around(entry.node, [&](int other) {
      if (other != goal && distance_[other] < room) return;
      reached(other, entry.node, entry.cost + norm(lattice_.at(other) - here));
    });
  }
  return path;
}

}  // namespace irsim
