// The moving objects of one world as ORCA sees them in one step.
#pragma once

#include <vector>

#include "orca/constraints.hpp"
#include "orca/detour.hpp"
#include "orca/free_cells.hpp"
#include "orca/hulls.hpp"
#include "orca/nearest.hpp"

namespace irsim {

struct State;
struct World;
struct Workspace;

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

/// Scratch memory of the behaviors that are built on ORCA: `orca` and `avocado`. Movers have the indices of
/// World::moving.
struct OrcaCrowd {
  bool known = false;             // whether it holds the present step
  std::vector<OrcaAgent> movers;  // bounding circles; those of these behaviors include their margin
  std::vector<int> group;         // index in World::behaviors of the group that moves each now; -1 without one
  std::vector<int> member_of;     // the same, also for objects that are stopped or have a given command
  Nearest nearest;                // positions of the movers
  std::vector<std::vector<int>> neighbors_before;  // movers that each mover has avoided in an earlier step
  // for the object that decides
  std::vector<Nearest::Found> neighbors;  // movers, or static discs, nearest first
  std::vector<Nearest::Found> edges;      // edges that face it, nearest first
  std::vector<HalfPlane> planes, scratch;
  FootprintCrowd outlines;
};

/// The movers of world w, which the first call of a step computes.
OrcaCrowd& crowd(const World& world, const State& state, Workspace& work, int w);

}  // namespace irsim
