// Which bodies may meet in this step, and in which order their contacts are resolved.
#include <algorithm>

#include "contact/solver.hpp"

namespace irsim {

double ContactSolver::reach_per_step() const {
  double fastest = 0.0;
  for (const int i : world_.moving) {
    const Vec3& limits = state_.vel_max[first_ + i];
    double top = world_.dynamics[i].driven ? limits[0] : 0.0;
    with(world_.drive[i], [&](const auto& drive) { top = travel_speed(drive, limits); });
    if (std::isfinite(top)) fastest = std::max(fastest, top);
    fastest = std::max(fastest, norm(buffers_.bodies[i].start_velocity));
  }
  return 2.0 * world_.step_time * fastest + 1e-6;  // pushes of a whole step, even in a part of it
}

void ContactSolver::add_candidate(int i, int j) {
  if (world_.unobstructed[i] || world_.unobstructed[j]) return;
  add_pair(buffers_.found, Pair{std::min(i, j), std::max(i, j)});
}

void ContactSolver::find_pairs() {
  buffers_.found.clear();
  const double wide = reach_per_step();
  const auto widened = [](const Box& box, double by) {
    return Box{box.x0 - by, box.y0 - by, box.x1 + by, box.y1 + by};
  };
  if (!world_.fixed_objects.empty()) {
    for (const int i : world_.moving) {
      scene_.fixed->grid.query(widened(buffers_.bodies[i].box, wide), [&](int j) { add_candidate(i, j); });
    }
  }
  if (world_.moving.size() > 1) {
    scene_.sweep.pairs([&](int i) { return widened(buffers_.bodies[i].box, 0.5 * wide); },
                       [&](int i, int j) { add_candidate(i, j); });
  }
}

void ContactSolver::collect_pairs(bool as_given) {
  buffers_.pairs.clear();
  if (!as_given) {
    std::sort(buffers_.found.begin(), buffers_.found.end());
    buffers_.found.erase(std::unique(buffers_.found.begin(), buffers_.found.end()), buffers_.found.end());
  }
  for (std::size_t k = 0; k < buffers_.found.size(); ++k) {
    const auto [i, j] = buffers_.found[k];
    if (!world_.dynamics[i].pushable && !world_.dynamics[j].pushable) continue;
    if (as_given &&
        std::find(buffers_.found.begin(), buffers_.found.begin() + k, buffers_.found[k]) != buffers_.found.begin() + k)
      continue;
    buffers_.pairs.push_back({i, j, 0, 0, 0, false, {}, -1, 0.0, false, false});
    if (!buffers_.bodies[i].placed) place(i);
    if (!buffers_.bodies[j].placed) place(j);
  }
}

void ContactSolver::rank_boxes() {
  buffers_.outer.resize(world_.objects);
  const Shapes& shapes = *scene_.shapes;
  for (int i = 0; i < world_.objects; ++i) {
    buffers_.outer[i] =
        world_.is_static[i] ? scene_.fixed->outlines.boxes[shapes.placed[i].object] : buffers_.bodies[i].box;
  }
  buffers_.packing.pack(buffers_.outer);
}

void ContactSolver::order_pairs(bool as_given) {
  const int n = world_.objects;
  buffers_.first_link.assign(n + 1, 0);
  for (const Buffers::Pair& p : buffers_.pairs) ++buffers_.first_link[p.a], ++buffers_.first_link[p.b];
  int sum = 0;
  for (int& first : buffers_.first_link) sum += first, first = sum - first;
  buffers_.links.resize(2 * buffers_.pairs.size());
  buffers_.queue.assign(buffers_.first_link.begin(), buffers_.first_link.end());
  for (std::size_t k = 0; k < buffers_.pairs.size(); ++k) {
    buffers_.links[buffers_.queue[buffers_.pairs[k].a]++] = static_cast<int>(k);
    buffers_.links[buffers_.queue[buffers_.pairs[k].b]++] = static_cast<int>(k);
  }
  buffers_.distance.assign(n, n);
  buffers_.queue.clear();
  for (const Buffers::Pair& p : buffers_.pairs) {
    for (const int i : {p.a, p.b}) {
      if (world_.dynamics[i].pushable || buffers_.distance[i] == 0) continue;
      buffers_.distance[i] = 0;
      buffers_.queue.push_back(i);
    }
  }
  for (std::size_t head = 0; head < buffers_.queue.size(); ++head) {
    const int i = buffers_.queue[head];
    for (int k = buffers_.first_link[i]; k < buffers_.first_link[i + 1]; ++k) {
      const Buffers::Pair& p = buffers_.pairs[buffers_.links[k]];
      const int j = p.a == i ? p.b : p.a;
      if (buffers_.distance[j] <= buffers_.distance[i] + 1) continue;
      buffers_.distance[j] = buffers_.distance[i] + 1;
      buffers_.queue.push_back(j);
    }
  }
  for (Buffers::Pair& p : buffers_.pairs) p.order = buffers_.distance[p.a] + buffers_.distance[p.b];
  if (as_given) {
    std::stable_sort(buffers_.pairs.begin(), buffers_.pairs.end(),
                     [](const Buffers::Pair& p, const Buffers::Pair& q) { return p.order < q.order; });
  } else {
    rank_boxes();
    const std::vector<int>& rank = buffers_.packing.rank;
    std::sort(buffers_.pairs.begin(), buffers_.pairs.end(), [&](const Buffers::Pair& p, const Buffers::Pair& q) {
      return p.order != q.order ? p.order < q.order : p.a != q.a ? p.a < q.a : rank[p.b] < rank[q.b];
    });
  }
  for (std::size_t k = 0; k < buffers_.pairs.size(); ++k) {  // the links of each object follow the new order
    if (k == 0) buffers_.queue.assign(buffers_.first_link.begin(), buffers_.first_link.end());
    buffers_.links[buffers_.queue[buffers_.pairs[k].a]++] = static_cast<int>(k);
    buffers_.links[buffers_.queue[buffers_.pairs[k].b]++] = static_cast<int>(k);
  }
}

}  // namespace irsim
