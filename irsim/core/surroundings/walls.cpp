#include "surroundings/walls.hpp"

#include <algorithm>

#include "surroundings/outline_union.hpp"
#include "world/features.hpp"
#include "world/scene.hpp"
#include "world/world.hpp"

namespace irsim {
namespace {

constexpr double kWallCell = 4.0;            // cell size of the grid of walls [m]
constexpr int kCorners = 16;                 // corners of the polygon that stands for a circle of a compound
constexpr double kClosed = 1e-9;             // a line whose ends are this close is closed [m]
constexpr double kBeyond = 1.0 + 1e-9;       // so that rounding does not decide
constexpr std::size_t kMaxLinearWalls = 24;  // up to this many walls are searched one by one

/// Whether a corner is left of another one, or below it.
bool is_before(Vec2 a, Vec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

/// Whether the edges of a closed outline meet only where one follows the other.
bool is_simple(const std::vector<Vec2>& ring) {
  const std::size_t n = ring.size();
  Vec2 where;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = i + 2; k < n; ++k) {
      if (i == 0 && k == n - 1) continue;
      if (segments_meet(ring[i], ring[i + 1], ring[k], ring[(k + 1) % n], where)) return false;
    }
  }
  return n >= 3;
}

/// Add both sides of a polyline. A closed one has an outer and an inner side; any other is an outline without area,
/// which leads to its end and back.
void add_line(Walls& walls, const Vec2* vertices, int count, int object) {
  std::vector<Vec2> ring(vertices, vertices + count);
  const bool closed = norm(ring.front() - ring.back()) <= kClosed;
  if (closed) ring = bends_of(vertices, count - 1);
  if (closed && is_simple(ring)) {
    if (twice_area(ring) < 0.0) std::reverse(ring.begin(), ring.end());
    walls.add_ring(ring.data(), static_cast<int>(ring.size()), Inside::shell, object);
    std::reverse(ring.begin(), ring.end());
    return walls.add_ring(ring.data(), static_cast<int>(ring.size()), Inside::lining, object);
  }
  ring.assign(vertices, vertices + count);
  for (int k = count - 2; k > 0; --k) ring.push_back(vertices[k]);
  walls.add_ring(ring.data(), static_cast<int>(ring.size()), Inside::solid, object);
}

/// The outline of a polygon or of a circle of a compound, counter-clockwise.
std::vector<Vec2> outline_of(const Footprint& body, const Part& part) {
  const Vec2* vertices = body.vertices + part.first;
  std::vector<Vec2> ring;
  if (part.kind == Kind::circle) {
    const double radius = part.radius / std::cos(kPi / kCorners);
    for (int k = 0; k < kCorners; ++k) ring.push_back(*vertices + unit(kTurn * k / kCorners) * radius);
    return ring;
  }
  ring.assign(vertices, vertices + (part.last - part.first));
  if (part.turn < 0.0) std::reverse(ring.begin() + 1, ring.end());
  return ring;
}

void add_body(Walls& walls, const Footprint& body, int object) {
  const Part& part = body.parts[0];
  const Vec2* vertices = body.vertices + part.first;
  const int count = part.last - part.first;
  if (part.cells != nullptr) {
    for (const std::vector<Vec2>& ring : part.cells->outline())
      walls.add_ring(ring.data(), static_cast<int>(ring.size()),
                     twice_area(ring) < 0.0 ? Inside::hollow : Inside::solid, object);
    return;
  }
  if (part.kind == Kind::linestring) return add_line(walls, vertices, count + 1, object);
  if (part.kind == Kind::room) {  // a room is solid outside, so its outline is clockwise
    std::vector<Vec2> ring(vertices, vertices + count);
    if (twice_area(ring) > 0.0) std::reverse(ring.begin(), ring.end());
    return walls.add_ring(ring.data(), static_cast<int>(ring.size()), Inside::hollow, object);
  }
  std::vector<std::vector<Vec2>> rings;
  for (int p = 0; p < body.count; ++p) rings.push_back(outline_of(body, body.parts[p]));
  if (rings.size() > 1) rings = union_of(rings);
  for (const std::vector<Vec2>& ring : rings)
    walls.add_ring(ring.data(), static_cast<int>(ring.size()),
                   rings.size() > 1 && twice_area(ring) < 0.0 ? Inside::lining : Inside::solid, object);
}

/// Write the indices, ascending, of the walls within `reach` [m] of `centre` for which `counts(side)` holds. `side` is
/// the distance of `centre` from the line of the wall times the length of the wall, positive inside.
template <class Counts>
void search(const Walls& walls, Vec2 centre, double reach, std::vector<int>& found, Counts&& counts) {
  found.clear();
  const double reach2 = reach * reach;
  const auto offer = [&](int k) {
    const Vec2 a = walls.list[k].a, b = walls.list[k].b;
    const double side = cross(b - a, centre - a);
    if (!counts(side) || side * side > kBeyond * reach2 * squared(b - a)) return;  // its line is farther away
    if (squared(nearest_on_segment(a, b, centre) - centre) <= reach2) found.push_back(k);
  };
  const Box area = box_around(centre, reach * kBeyond);
  if (walls.list.size() <= kMaxLinearWalls || !std::isfinite(reach)) {
    for (const Ring& ring : walls.rings) {
      if (!ring.meets(area)) continue;
      for (int k = ring.first; k < ring.last; ++k) offer(k);
    }
    return;
  }
  walls.grid.query(area, offer);
  std::sort(found.begin(), found.end());
}

}  // namespace

void Walls::add_ring(const Vec2* corners, int count, Inside inside, int object) {
  std::vector<Vec2> bends = bends_of(corners, count);
  std::rotate(bends.begin(), std::min_element(bends.begin(), bends.end(), is_before), bends.end());
  const int first = static_cast<int>(list.size()), n = static_cast<int>(bends.size());
  if (n < 2) return;
  for (int k = 0; k < n; ++k) {
    list.push_back({bends[k], bends[(k + 1) % n], object, first + (k + 1) % n, first + (k + n - 1) % n,
                    static_cast<int>(rings.size())});
  }
  Ring& ring = rings.emplace_back(bends, inside, object);
  ring.first = first, ring.last = first + n;
}

void Walls::build() {
  grid.clear(kWallCell);
  for (std::size_t k = 0; k < list.size(); ++k) {
    Box box;
    box.include(list[k].a);
    box.include(list[k].b);
    grid.add(static_cast<int>(k), box);
  }
  grid.build();
}

void Walls::within(Vec2 centre, double reach, std::vector<int>& found) const {
  search(*this, centre, reach, found, [](double) { return true; });
}

void Walls::facing(Vec2 centre, double reach, FacingWalls& last) const {
  if (last.known && last.centre.x == centre.x && last.centre.y == centre.y && last.reach == reach) return;
  last.known = true, last.centre = centre, last.reach = reach;
  search(*this, centre, reach, last.found, [](double side) { return side <= 0.0; });
}

Walls make_walls(const World& world, const Shapes& shapes, const Fixed& fixed) {
  Walls walls;
  // The outline of a map is long, so it is made only if a behavior uses it.
  const bool avoids = std::any_of(world.behaviors.begin(), world.behaviors.end(), [](const BehaviorGroup& group) {
    return !std::holds_alternative<DashOptions>(group.behavior);
  });
  for (const int i : world.fixed_objects) {
    const Footprint body = fixed.outlines.footprint(shapes, i);
    const Kind kind = body.parts[0].kind;
    if ((world.unobstructed[i] && kind != Kind::linestring) || !body.box.finite()) continue;
    if ((body.count == 1 && kind == Kind::circle) || (kind == Kind::cells && !avoids)) continue;
    add_body(walls, body, i);
  }
  walls.build();
  return walls;
}

}  // namespace irsim
