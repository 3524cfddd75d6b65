#include "footprints/detour.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/predicates.hpp"

namespace irsim {
namespace {

constexpr double kFinestCell = 0.1;   // [m]
constexpr int kMostCells = 120;       // per side of the grid
constexpr double kAround = 1.5;       // free space round everything, through which a way may lead [m]
constexpr double kSmall = 0.5;        // bodies up to this radius need no more space than that [m]
constexpr double kAside = 4.0;        // no way leads farther aside of the straight line, or back, plus the space [m]
constexpr double kComfort = 0.15;     // clearance that a way keeps if it is not much longer [m]
constexpr double kTightCost = 30.0;   // factor on the length of a part on which the disc overlaps something
constexpr double kComfortCost = 2.0;  // factor on the length of a part without clearance, added to 1
constexpr double kLeaving = 0.3;      // distance from the start within which any overlap may be left [m]
constexpr double kGreed =
    1.2;  // factor on the distance that is left: ways may be longer by a fifth, and are found sooner
constexpr double kPullClearance = 0.03;  // clearance of the straight parts [m]

Hull capsule(const Vec2* ends, const Vec2* normals, double radius) { return {ends, normals, 2, radius}; }

/// Distance of a point from a hull [m]; 0 inside.
double distance_to(const Hull& hull, Vec2 p) {
  if (hull.count == 1) return std::max(0.0, norm(p - hull.corner[0]) - hull.round);
  bool inside = hull.count > 2;
  double least = kInfinity;
  for (int k = 0; k < hull.count; ++k) {
    const Vec2 a = hull.corner[k], b = hull.corner[(k + 1) % hull.count];
    if (dot(hull.normal[k], p - a) > 0.0) inside = false;
    least = std::min(least, squared(nearest_on_segment(a, b, p) - p));
  }
  return inside ? 0.0 : std::max(0.0, std::sqrt(least) - hull.round);
}

/// Factor on the length of a way through a point; infinite if it is closed.
double price_of(Vec2 p, Vec2 start, double radius, double overlap, const std::vector<Blocker>& blockers,
                const std::vector<DetourMemory::Reach>& reaches) {
  double clear = kComfort;
  for (std::size_t k = 0; k < reaches.size(); ++k) {
    if (squared(p - reaches[k].centre) >= reaches[k].far2) continue;
    clear = std::min(clear, distance_to(blockers[k].hull, p) - radius);
    if (clear <= -overlap) break;
  }
  if (clear >= 0.0) return 1.0 + kComfortCost * (1.0 - clear / kComfort);
  return clear > -overlap || squared(p - start) < kLeaving * kLeaving ? kTightCost : kInfinity;
}

}  // namespace

bool is_open(Vec2 a, Vec2 b, double radius, const std::vector<Blocker>& blockers) {
  const Vec2 ends[] = {a, b}, along = b - a;
  const double length = norm(along);
  const Vec2 side = length > 0.0 ? Vec2{along.y, -along.x} * (1.0 / length) : Vec2{};
  const Vec2 normals[] = {side, side * -1.0};
  for (const Blocker& one : blockers) {
    const double reach = one.radius + radius;
    if (squared(nearest_on_segment(a, b, one.centre) - one.centre) >= reach * reach) continue;
    if (separation(capsule(ends, normals, radius), one.hull).gap < 0.0) return false;
  }
  return true;
}

bool find_detour(Vec2 start, Vec2 goal, double reach, double radius, double overlap,
                 const std::vector<Blocker>& blockers, DetourMemory& memory, std::vector<Vec2>& points) {
  // The grid lies along the straight line, so that a turned world gives turned ways.
  const double distance = norm(goal - start);
  const Vec2 ahead = distance > 0.0 ? (goal - start) * (1.0 / distance) : Vec2{1.0, 0.0};
  const auto local = [&](Vec2 p) { return unrotate(p - start, ahead); };
  Box box;
  box.include(Vec2{});
  box.include(Vec2{distance, 0.0});
  const auto include = [&](Vec2 p) {
    box.include(Vec2{clip(p.x, -kAside, distance + kAside), clip(p.y, -kAside, kAside)});
  };
  for (const Blocker& one : blockers) {
    const Vec2 at = local(one.centre);
    include(at);
    if (one.radius <= kSmall) continue;
    const double extent = one.hull.round;
    for (int k = 0; k < one.hull.count; ++k) {
      const Vec2 corner = local(one.hull.corner[k]);
      include({corner.x - extent, corner.y - extent}), include({corner.x + extent, corner.y + extent});
    }
  }
  box = {box.x0 - kAround, box.y0 - kAround, box.x1 + kAround, box.y1 + kAround};
  const double cell = std::max(kFinestCell, std::max(box.x1 - box.x0, box.y1 - box.y0) / kMostCells);
  // A cell has its centre at the start.
  box.x0 = (std::floor(box.x0 / cell) - 0.5) * cell, box.y0 = (std::floor(box.y0 / cell) - 0.5) * cell;
  const int columns = static_cast<int>((box.x1 - box.x0) / cell) + 1;
  const int rows = static_cast<int>((box.y1 - box.y0) / cell) + 1;
  const auto centre = [&](int k) {
    return start + rotate({box.x0 + (k % columns + 0.5) * cell, box.y0 + (k / columns + 0.5) * cell}, ahead);
  };
  const auto cell_of = [&](Vec2 p) {
    const Vec2 at = local(p);
    const int x = static_cast<int>(clip((at.x - box.x0) / cell, 0.0, columns - 1.0));
    const int y = static_cast<int>(clip((at.y - box.y0) / cell, 0.0, rows - 1.0));
    return y * columns + x;
  };
  const std::size_t size = static_cast<std::size_t>(columns) * rows;
  memory.reaches.clear();
  for (const Blocker& one : blockers) {
    const double far = one.radius + radius + kComfort;
    memory.reaches.push_back({one.centre, far * far});
  }
  memory.price.assign(size, 0.0f);
  memory.cost.assign(size, std::numeric_limits<float>::infinity());
  memory.parent.resize(size);
  const auto price = [&](int k) {
    float& known = memory.price[k];
    if (known == 0.0f)
      known = static_cast<float>(price_of(centre(k), start, radius, overlap, blockers, memory.reaches));
    return known;
  };
  const auto remaining = [&](int k) { return kGreed * std::max(0.0, norm(centre(k) - goal) - reach); };
  using Entry = std::pair<float, std::int32_t>;
  const auto later = [](const Entry& a, const Entry& b) { return a > b; };
  memory.heap.clear();
  const int first = cell_of(start);
  int best = first, found = -1;
  memory.cost[first] = 0.0f, memory.parent[first] = -1;
  memory.heap.push_back({static_cast<float>(remaining(first)), first});
  while (!memory.heap.empty()) {
    std::pop_heap(memory.heap.begin(), memory.heap.end(), later);
    const auto [key, k] = memory.heap.back();
    memory.heap.pop_back();
    const double left = remaining(k), cost = memory.cost[k];
    if (key > cost + left + 1e-4) continue;
    if (left < remaining(best)) best = k;
    if (left <= 0.0) {
      found = k;
      break;
    }
    const int x = k % columns, y = k / columns;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if ((dx == 0 && dy == 0) || x + dx < 0 || x + dx >= columns || y + dy < 0 || y + dy >= rows) continue;
        const int other = k + dy * columns + dx;
        const double step = cell * (dx != 0 && dy != 0 ? 1.41421356 : 1.0) * price(other);
        const float total = static_cast<float>(cost + step);
        if (!(total < memory.cost[other])) continue;
        memory.cost[other] = total;
        memory.parent[other] = k;
        memory.heap.push_back({static_cast<float>(total + remaining(other)), other});
        std::push_heap(memory.heap.begin(), memory.heap.end(), later);
      }
    }
  }
  memory.cells.clear();
  for (int k = found >= 0 ? found : best; k >= 0; k = memory.parent[k]) memory.cells.push_back(centre(k));
  std::reverse(memory.cells.begin(), memory.cells.end());
  points.clear();
  Vec2 from = start;
  std::size_t k = 1;
  while (k < memory.cells.size()) {
    while (k + 1 < memory.cells.size() && is_open(from, memory.cells[k + 1], radius + kPullClearance, blockers)) ++k;
    from = memory.cells[k++];
    points.push_back(from);
  }
  return found >= 0;
}

}  // namespace irsim
