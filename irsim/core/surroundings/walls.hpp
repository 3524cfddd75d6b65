// Walls: the segments of what stands still and is not a circle.
#pragma once

#include <vector>

#include "collision/grid.hpp"
#include "geometry/predicates.hpp"
#include "geometry/vec.hpp"

namespace irsim {

struct Fixed;
struct World;
struct Shapes;

/// A segment, world frame. Of an outline the inside is on the left of a -> b.
struct Wall {
  Vec2 a, b;
  int object;
  int next, previous;  // walls that start at b and end at a; -1: none, a free end
};

/// Segments and where they are.
struct Walls {
  std::vector<Wall> list;
  Grid grid;

  /// A closed outline, `count` corners; `turn` < 0: given clockwise.
  void add_ring(const Vec2* corners, int count, double turn, int object);
  /// An open polyline.
  void add_chain(const Vec2* corners, int count, int object);
  /// After the last wall; questions are possible afterwards.
  void build();
  /// Indices, ascending, of the walls that come within `reach` [m] of `centre`, in `found`.
  void within(Vec2 centre, double reach, std::vector<int>& found) const;
};

/// The outlines of static objects that are neither circles nor linestrings nor `unobstructed` (a circle that is part of
/// a compound counts by a polygon about it; that of a map is left out where nobody has a behavior that avoids).
Walls make_walls(const World& world, const Shapes& shapes, const Fixed& fixed);
/// The segments of static linestrings, `unobstructed` ones too.
Walls make_lines(const World& world, const Shapes& shapes, const Fixed& fixed);

/// Calls `visit(wall)` for each wall within `reach` [m] of `centre`, by ascending index. `found` is scratch memory.
template <class Visit>
void for_walls(const Walls& walls, std::vector<int>& found, Vec2 centre, double reach, Visit&& visit) {
  if (walls.list.empty()) return;
  walls.within(centre, reach, found);
  for (const int k : found) visit(walls.list[k]);
}

}  // namespace irsim
