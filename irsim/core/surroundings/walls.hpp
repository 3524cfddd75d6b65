// Walls: the segments of static objects other than circles. However an outline is written, its walls are the same.
#pragma once

#include <vector>

#include "collision/grid.hpp"
#include "geometry/predicates.hpp"
#include "geometry/vec.hpp"
#include "surroundings/rings.hpp"

namespace irsim {

struct Fixed;
struct World;
struct Shapes;

/// A segment, world frame. The inside of an outline is on the left of a -> b.
struct Wall {
  Vec2 a, b;
  int object;
  int next, previous;  // walls that start at b and end at a
  int ring;            // index in Walls::rings
};

/// The walls within `reach` [m] that face a place: scratch memory that keeps the last answer of a step.
struct FacingWalls {
  bool known = false;  // whether it holds an answer of the present step
  Vec2 centre;
  double reach = 0.0;
  std::vector<int> found;
};

/// Segments in rings, and a grid to find them. The walls of a ring are in a row.
struct Walls {
  std::vector<Wall> list;
  std::vector<Ring> rings;
  Grid grid;

  /// Add a closed outline. Its solid side is on the left of its walls.
  void add_ring(const Vec2* corners, int count, Inside inside, int object);
  /// Build the grid after the last wall was added; queries are possible afterwards.
  void build();
  /// Write the indices, ascending, of the walls within `reach` [m] of `centre` to `found`.
  void within(Vec2 centre, double reach, std::vector<int>& found) const;
  /// The same, for the walls that face `centre`; nothing is done if `last` is the answer already.
  void facing(Vec2 centre, double reach, FacingWalls& last) const;
};

/// The outlines of static objects other than circles. Linestrings have walls on both sides, `unobstructed` ones
/// too; other `unobstructed` shapes have no walls. The parts of a compound make one outline, in which a polygon stands
/// for a circle. Outlines of maps are left out if no behavior avoids obstacles.
Walls make_walls(const World& world, const Shapes& shapes, const Fixed& fixed);

/// Call `visit(wall)` for each wall within `reach` [m] of `centre`, by ascending index. `found` is scratch memory.
template <class Visit>
void for_walls(const Walls& walls, std::vector<int>& found, Vec2 centre, double reach, Visit&& visit) {
  if (walls.list.empty()) return;
  walls.within(centre, reach, found);
  for (const int k : found) visit(walls.list[k]);
}

}  // namespace irsim
