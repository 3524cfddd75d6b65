// Everybody in one world as ORCA sees them in one step, and scratch memory.
#pragma once

#include <vector>

#include "orca/constraints.hpp"
#include "orca/nearest.hpp"

namespace irsim {

struct State;
struct World;
struct Workspace;

/// Scratch memory of the behavior `orca`. Movers are counted as in World::moving.
struct OrcaCrowd {
  bool known = false;             // whether the movers are those of the present step
  std::vector<OrcaAgent> movers;  // bounding circles; of those who avoid by ORCA with their margin
  std::vector<int> group;         // which entry of World::behaviors makes them avoid others by ORCA now; -1: none
  std::vector<int> member_of;     // the same, or what would if they could move
  Nearest nearest;                // positions of the movers
  // of one of them
  std::vector<Nearest::Found> neighbors;  // nearest first
  std::vector<Nearest::Found> edges;      // the same for edges that face it
  std::vector<HalfPlane> planes, scratch;
};

/// Who moves in world w, made on the first call of a step.
OrcaCrowd& crowd(const World& world, const State& state, Workspace& work, int w);

}  // namespace irsim
