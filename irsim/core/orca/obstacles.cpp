#include "orca/obstacles.hpp"

#include "world/scene.hpp"
#include "world/world.hpp"

namespace irsim {
namespace {

constexpr double kCell = 4.0;  // cell size of the grid [m]

/// The unit vector of a wall; zero for a wall without length.
Vec2 along(const Wall& wall) {
  const Vec2 way = wall.b - wall.a;
  const double length = norm(way);
  return length > 0.0 ? way * (1.0 / length) : Vec2{};
}

/// The unit vector of the next wall with a length in the direction of `link`.
Vec2 beyond(const Walls& walls, int k, int Wall::* link) {
  for (std::size_t tries = 0; tries < walls.list.size(); ++tries) {
    k = walls.list[k].*link;
    const Vec2 way = along(walls.list[k]);
    if (squared(way) > 0.0) return way;
  }
  return {};
}

Corner corner(Vec2 point, Vec2 in, Vec2 out) { return {point, in, out, cross(in, out) >= 0.0}; }

void add_edges(std::vector<Edge>& edges, const Walls& walls, const World& world) {
  for (int k = 0; k < static_cast<int>(walls.list.size()); ++k) {
    const Wall& wall = walls.list[k];
    const Vec2 way = along(wall);
    if (squared(way) == 0.0 || (wall.object >= 0 && world.unobstructed[wall.object])) continue;
    const Vec2 before = beyond(walls, k, &Wall::previous), after = beyond(walls, k, &Wall::next);
    const int ring = walls.rings[wall.ring].corners.empty() ? -1 : wall.ring;
    edges.push_back({corner(wall.a, before, way), corner(wall.b, way, after), wall.object, ring});
  }
}

}  // namespace

Obstacles make_obstacles(const World& world, const Shapes& shapes, const Fixed& fixed) {
  Obstacles all;
  add_edges(all.edges, fixed.walls, world);
  for (const int i : fixed.disc_ids) {
    if (world.unobstructed[i] || !fixed.outlines.footprint(shapes, i).box.finite()) continue;
    all.discs.push_back({fixed.outlines.footprint(shapes, i).centre, shapes.radius[i], i});
  }
  all.grid.clear(kCell);
  int id = 0;
  for (const Edge& edge : all.edges) {
    Box box;
    box.include(edge.left.point);
    box.include(edge.right.point);
    all.grid.add(id++, box);
  }
  for (const StaticDisc& disc : all.discs) all.grid.add(id++, box_around(disc.centre, disc.radius));
  all.grid.build();
  return all;
}

}  // namespace irsim
