// Who is near: what behaviors see of other objects, found in time that does not grow with their number.
#pragma once

#include <vector>

#include "collision/points.hpp"
#include "geometry/vec.hpp"

namespace irsim {

struct World;
struct State;
struct Workspace;

/// An object as behaviors of circles see it, world frame: a disc about the centroid of its area (of a compound: about
/// its bounding circle's centre) that is as large as its bounding circle.
struct Disc {
  Vec2 centre, velocity;  // [m], [m/s]
  double radius;          // [m]
  int object = -1;        // its id
};

/// The moving objects of one world at the snapshot of a step. Scratch memory: filled by the first question of a step.
struct Neighbors {
  bool known = false;  // whether it is about the present step
  // by position in World::moving
  std::vector<Vec2> bounds;  // centre of the bounding circle; NaN for linestrings
  std::vector<Disc> discs;
  std::vector<int> lines;  // ids of moving linestrings
  // no disc, and no origin, is farther than this from the centre of the bounding circle [m]
  double off_centre = 0, off_origin = 0;

  struct Level {
    double cell;
    Points points;
  };
  std::vector<Level> levels;  // of `bounds`; the first `used` belong to the present step
  std::size_t used = 0;
  std::vector<int> found;     // the answer to the last question
  std::vector<double> extra;  // a row of State::extra
};

/// The snapshot of world w, made on the first call of a step.
const Neighbors& neighbors(const World& world, const State& state, Workspace& work, int w);
/// Ids, ascending, of the objects but linestrings whose bounding circle has its centre at most `reach` [m] away from
/// `centre`: all that move, and static circles (other static objects are walls, see walls.hpp). Valid until the next
/// call with this workspace.
const std::vector<int>& neighbors_within(const World& world, const State& state, Workspace& work, int w, Vec2 centre,
                                         double reach);
/// The disc of an object; for objects that move after `neighbors` has been asked in this step.
Disc disc_of(const World& world, const State& state, const Workspace& work, int w, int object);

/// Calls `visit(id)` for each of `neighbors_within`, in that order. `visit` must not ask for neighbours itself.
template <class Visit>
void for_neighbors(const World& world, const State& state, Workspace& work, int w, Vec2 centre, double reach,
                   Visit&& visit) {
  for (const int id : neighbors_within(world, state, work, w, centre, reach)) visit(id);
}

}  // namespace irsim
