// The moving objects of one world as `footprint_orca` sees them in one step.
#pragma once

#include <vector>

#include "orca/detour.hpp"
#include "orca/free_cells.hpp"
#include "orca/hull_planes.hpp"
#include "orca/hulls.hpp"

namespace irsim {

struct Threat {
  VelocityCone cone;
  Vec2 base;  // the relative velocity is that of the object times `gain` minus this [m/s]
  double gain;
  bool standing;
};
struct Fixture {
  Hull hull;
  double gap;
};
struct Option {
  double cost;
  Vec2 velocity;
};

/// The outlines of the movers, which `footprint_orca` makes when it first decides in a step.
struct FootprintCrowd {
  bool known = false;
  Hulls hulls;  // of the movers
  std::vector<Blocker> blockers;
  DetourMemory search;
  // for the object that decides
  Hulls walls;
  std::vector<Border> borders;
  std::vector<double> extra;
  std::vector<Threat> threats;
  std::vector<Fixture> fixed;
  std::vector<Vec2> moved;
  std::vector<Face> faces;
  std::vector<Option> tries;
};

}  // namespace irsim
