// The moving objects of one world as `footprint_orca` sees them in one step.
#pragma once

#include <vector>

#include "footprints/detour.hpp"
#include "footprints/free_cells.hpp"
#include "footprints/hulls.hpp"
#include "footprints/velocity_cones.hpp"

namespace irsim {

/// Something that an object may collide with if it takes a velocity.
struct Threat {
  VelocityCone cone;
  double gain;     // the relative velocity is `gain` times the object's
  Vec2 base;       // minus this [m/s]
  double horizon;  // later collisions do not matter [s]
  bool standing;
};

/// How far a mover can get until it stands.
struct MoverReach {
  int stop = -1;        // its hull among `FootprintCrowd::stops`; -1: the body, which stops at once or stands
  Vec2 centre;          // of a circle round this hull
  double radius = 0.0;  // [m]
  double range = 0.0;   // its points move no farther in a step and the stop after it [m]
  double play = 0.0;    // nor farther from the hull of the stop that could begin now [m]
  bool glides = false;  // whether it cannot stop at once
};

/// Scratch memory. The first object that decides in a step fills the first part, each object the second one.
struct FootprintCrowd {
  bool known = false;  // whether it holds the present step
  Hulls hulls;         // of the movers
  Hulls stops;         // of all their places until they have stopped
  std::vector<MoverReach> reaches;
  double widest = 0.0;           // largest sum of range and radius of a mover [m]
  std::vector<Blocker> resting;  // movers that stand for good, or have arrived and rest

  std::vector<int> others;  // movers that the object avoids, nearest first
  Hulls walls;              // static obstacles near it
  std::vector<Threat> threats;
  std::vector<Face> faces;
  FreeCell cell;                  // where it may be until it stands
  std::vector<Blocker> blockers;  // what its way leads round
  DetourMemory search;
  Manoeuvre way;  // of a control that is tried
  std::vector<double> extra;
};

}  // namespace irsim
