// An object with `footprint_orca` while it decides, and the two halves of its decision.
#pragma once

#include "behaviors/footprint_orca.hpp"
#include "footprints/crowd.hpp"
#include "orca/crowd.hpp"

namespace irsim {

struct FootprintSelf {
  const FootprintOrcaOptions& options;
  const Decision& decision;
  const OrcaCrowd& all;
  FootprintCrowd& crowd;
  int object, row, mover;
  Hull hull;
  Vec2 position, velocity, heading;
  double speed;      // largest [m/s]
  double turn_rate;  // largest, 0 for drives that keep their heading or must roll to turn [rad/s]
  bool slides;       // whether it can move sideways
  bool reverses;     // whether it may drive backward
  double reach;      // distance of its outermost point from its position [m]
  Ahead ahead;

  const World& world() const { return decision.world; }
  const State& state() const { return decision.state; }
  /// Largest distance that a point of it moves in a step [m].
  double stride() const { return (speed + turn_rate * reach) * world().step_time; }
  const MoverReach& limits() const { return crowd.reaches[mover]; }
};

/// Another mover, as an object knows it.
struct Encounter {
  int mover;
  bool standing, mutual, alike;  // alike: both decide with `footprint_orca` and see each other
  Vec2 moves;                    // its velocity [m/s]
};

/// Fill the part of the crowd that says how far movers get until they stand.
void fill_reaches(const Decision& decision, const OrcaCrowd& all, FootprintCrowd& crowd);

/// Bound the cell of an object by a mover, if either can reach the other. `apart`: of their hulls, if it is known.
void bound_by_mover(FootprintSelf& self, const Encounter& encounter, const Separation* apart);

/// Bound the cell by a static body, if the object can reach it.
void bound_by_wall(FootprintSelf& self, const Hull& wall, const Separation& apart);

/// The velocity that an object wants: to its goal, on a way round what stands [m/s].
Vec2 wanted_velocity(FootprintSelf& self);

/// The control with the best velocity that keeps the object within its cell.
Intent best_intent(FootprintSelf& self, Vec2 wanted);

}  // namespace irsim
