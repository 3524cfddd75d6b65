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
  double gain;     // the relative velocity is `gain` times that of the object
  Vec2 base;       // minus this [m/s]
  double horizon;  // later collisions do not matter [s]
  bool standing;
};

/// Scratch memory. The first object that decides in a step fills the first part, each object the second one.
struct FootprintCrowd {
  bool known = false;            // whether it holds the present step
  Hulls hulls;                   // of the movers
  std::vector<Blocker> resting;  // movers that stand for good, or have arrived and rest

  std::vector<int> others;  // movers that the object avoids, nearest first
  Hulls walls;              // static obstacles near it
  std::vector<Threat> threats;
  std::vector<Face> faces;
  FreeCell cell;                  // where it may be after the step
  std::vector<Blocker> blockers;  // what its way leads round
  DetourMemory search;
  std::vector<double> extra;
};

}  // namespace irsim
