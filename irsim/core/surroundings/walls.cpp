#include "surroundings/walls.hpp"

#include <algorithm>

#include "world/features.hpp"
#include "world/scene.hpp"
#include "world/world.hpp"

namespace irsim {
namespace {

constexpr double kCell = 4.0;                // cell size of the grid of walls [m]
constexpr int kCorners = 16;                 // corners of the polygon that stands for a circle of a compound
constexpr std::size_t kMaxLinearWalls = 24;  // up to this many walls are searched one by one

void add_part(Walls& walls, const Footprint& body, const Part& part, int object) {
  const Vec2* vertices = body.vertices + part.first;
  if (part.cells != nullptr) {
    for (const std::vector<Vec2>& ring : part.cells->outline())
      walls.add_ring(ring.data(), static_cast<int>(ring.size()), 1.0, object);
    return;
  }
  if (part.kind == Kind::room) {  // a room is solid outside, so its outline is clockwise
    std::vector<Vec2> ring(vertices, vertices + (part.last - part.first));
    if (twice_area(ring) > 0.0) std::reverse(ring.begin(), ring.end());
    return walls.add_ring(ring.data(), static_cast<int>(ring.size()), 1.0, object);
  }
  if (part.kind == Kind::polygon) return walls.add_ring(vertices, part.last - part.first, part.turn, object);
  Vec2 corners[kCorners];
  const double radius = part.radius / std::cos(kPi / kCorners);
  for (int k = 0; k < kCorners; ++k) corners[k] = *vertices + unit(kTurn * k / kCorners) * radius;
  walls.add_ring(corners, kCorners, 1.0, object);
}

}  // namespace

void Walls::add_ring(const Vec2* corners, int count, double turn, int object) {
  const int first = static_cast<int>(list.size());
  const auto corner = [&](int k) { return corners[turn < 0.0 ? (count - k) % count : k % count]; };
  for (int k = 0; k < count; ++k) {
    list.push_back({corner(k), corner(k + 1), object, first + (k + 1) % count, first + (k + count - 1) % count});
  }
}

void Walls::add_chain(const Vec2* corners, int count, int object) {
  const int first = static_cast<int>(list.size()), edges = count - 1;
  for (int k = 0; k < edges; ++k) {
    list.push_back(
        {corners[k], corners[k + 1], object, k + 1 < edges ? first + k + 1 : -1, k > 0 ? first + k - 1 : -1});
  }
}

void Walls::build() {
  grid.clear(kCell);
  for (std::size_t k = 0; k < list.size(); ++k) {
    Box box;
    box.include(list[k].a);
    box.include(list[k].b);
    grid.add(static_cast<int>(k), box);
  }
  grid.build();
}

void Walls::within(Vec2 centre, double reach, std::vector<int>& found) const {
  found.clear();
  const double reach2 = reach * reach;
  const auto near = [&](int k) {
    const Vec2 nearest = nearest_on_segment(list[k].a, list[k].b, centre);
    return squared(nearest - centre) <= reach2;
  };
  if (list.size() <= kMaxLinearWalls || !std::isfinite(reach)) {
    for (int k = 0; k < static_cast<int>(list.size()); ++k)
      if (near(k)) found.push_back(k);
    return;
  }
  grid.query(box_around(centre, reach), [&](int k) {
    if (near(k)) found.push_back(k);
  });
  std::sort(found.begin(), found.end());
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
    const bool plain = body.count == 1 && (kind == Kind::circle || kind == Kind::linestring);
    if (world.unobstructed[i] || plain || !body.box.finite() || (kind == Kind::cells && !avoids)) continue;
    for (int p = 0; p < body.count; ++p) add_part(walls, body, body.parts[p], i);
  }
  walls.build();
  return walls;
}

Walls make_lines(const World& world, const Shapes& shapes, const Fixed& fixed) {
  Walls walls;
  for (const int i : world.fixed_objects) {
    const Footprint body = fixed.outlines.footprint(shapes, i);
    const Part& part = body.parts[0];
    if (part.kind == Kind::linestring && body.box.finite())
      walls.add_chain(body.vertices + part.first, part.last - part.first + 1, i);
  }
  walls.build();
  return walls;
}

}  // namespace irsim
