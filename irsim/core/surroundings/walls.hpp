// Walls: the segments of static objects other than circles.
#pragma once

#include <vector>

#include "collision/grid.hpp"
#include "geometry/predicates.hpp"
#include "geometry/vec.hpp"

namespace irsim {

struct Fixed;
struct World;
struct Shapes;

/// A segment, world frame. The inside of an outline is on the left of a -> b.
struct Wall {
  Vec2 a, b;
  int object;
  int next, previous;  // walls that start at b and end at a; -1 at a free end
};

/// Segments and a grid to find them.
struct Walls {
  std::vector<Wall> list;
  Grid grid;

  /// Add a closed outline of `count` corners, which are clockwise if `turn` < 0.
  void add_ring(const Vec2* corners, int count, double turn, int object);
  /// Add an open polyline.
  void add_chain(const Vec2* corners, int count, int object);
  /// Build the grid after the last wall was added; queries are possible afterwards.
  void build();
  /// Write the indices, ascending, of the walls within `reach` [m] of `centre` to `found`.
  void within(Vec2 centre, double reach, std::vector<int>& found) const;
};

/// The outlines of static objects that are neither circles nor linestrings nor `unobstructed`. A polygon stands for a
/// circle that is part of a compound. Outlines of maps are left out if no behavior avoids obstacles.
Walls make_walls(const World& world, const Shapes& shapes, const Fixed& fixed);
/// The segments of static linestrings, including `unobstructed` ones.
Walls make_lines(const World& world, const Shapes& shapes, const Fixed& fixed);

/// Call `visit(wall)` for each wall within `reach` [m] of `centre`, by ascending index. `found` is scratch memory.
template <class Visit>
void for_walls(const Walls& walls, std::vector<int>& found, Vec2 centre, double reach, Visit&& visit) {
  if (walls.list.empty()) return;
  walls.within(centre, reach, found);
  for (const int k : found) visit(walls.list[k]);
}

}  // namespace irsim
