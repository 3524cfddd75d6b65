// The moving objects of one world as ORCA sees them in one step.
#pragma once

#include <memory>
#include <vector>

#include "orca/constraints.hpp"
#include "orca/nearest.hpp"

namespace irsim {

struct State;
struct World;
struct Workspace;

struct FootprintCrowd;

/// Scratch memory of the behaviors that are built on ORCA: `orca` and `avocado`. Movers have the indices of
/// World::moving.
struct OrcaCrowd {
  bool known = false;             // whether it holds the present step
  std::vector<OrcaAgent> movers;  // bounding circles; with these behaviors they include the margin
  std::vector<int> group;         // index in World::behaviors of the group that moves each now; -1 without one
  std::vector<int> member_of;     // the same, also for objects that are stopped or have a given command
  Nearest nearest;                // positions of the movers
  std::vector<double> speed2;     // of the movers, squared [m^2/s^2]
  double off_origin = 0;          // largest distance of a mover's origin from its position [m]
  std::vector<std::vector<int>> neighbors_before;  // movers that each mover has avoided in an earlier step
  // for the object that decides
  std::vector<Nearest::Found> neighbors;  // movers, or static discs, nearest first
  std::vector<Nearest::Found> edges;      // edges that face it, nearest first
  std::vector<HalfPlane> planes, scratch;
  std::shared_ptr<FootprintCrowd> outlines;  // scratch memory of `footprint_orca`, made when it is first needed
};

/// The movers of world w, which the first call of a step computes.
OrcaCrowd& crowd(const World& world, const State& state, Workspace& work, int w);

}  // namespace irsim
