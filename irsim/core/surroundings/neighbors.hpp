// Neighbors of a point: what behaviors see of other objects. The time of a query does not grow with their number.
#pragma once

#include <vector>

#include "collision/points.hpp"
#include "geometry/vec.hpp"

namespace irsim {

struct World;
struct State;
struct Workspace;

/// An object as behaviors see it, world frame: a disc of the size of its bounding circle about the centroid of its area
/// (for a compound: about the centre of the bounding circle).
struct Disc {
  Vec2 centre, velocity;  // [m], [m/s]
  double radius;          // [m]
  int object = -1;        // id
};

/// The moving objects of one world in the snapshot of a step: scratch memory that the first query of a step fills.
struct Neighbors {
  bool known = false;  // whether it holds the present step
  // (movers,) by index in World::moving
  std::vector<Vec2> bounds;  // centres of the bounding circles; NaN for linestrings
  std::vector<Disc> discs;
  std::vector<int> lines;  // ids of moving linestrings
  // largest distances of discs and of origins from the centre of the bounding circle [m]
  double off_centre = 0, off_origin = 0;

  struct Level {
    double cell;
    Points points;
  };
  std::vector<Level> levels;  // grids of `bounds`; the first `used` belong to the present step
  std::size_t used = 0;
  std::vector<int> found;     // result of the last query
  std::vector<int> tested;    // scratch memory of a query
  std::vector<double> extra;  // copy of a row of State::extra
};

/// The snapshot of world w, which the first call of a step makes.
const Neighbors& neighbors(const World& world, const State& state, Workspace& work, int w);
/// Ids, ascending, of moving objects and static circles whose bounding circles have their centre within `reach` [m] of
/// `centre`. Linestrings are left out; other static objects are walls, see walls.hpp. The result is valid until the
/// next call with this workspace.
const std::vector<int>& neighbors_within(const World& world, const State& state, Workspace& work, int w, Vec2 centre,
                                         double reach);
/// The disc of an object. For moving objects `neighbors` must have been called in this step.
Disc disc_of(const World& world, const State& state, const Workspace& work, int w, int object);

/// Call `visit(id)` for each of `neighbors_within`, in that order. `visit` must not query neighbors itself.
template <class Visit>
void for_neighbors(const World& world, const State& state, Workspace& work, int w, Vec2 centre, double reach,
                   Visit&& visit) {
  for (const int id : neighbors_within(world, state, work, w, centre, reach)) visit(id);
}

}  // namespace irsim
