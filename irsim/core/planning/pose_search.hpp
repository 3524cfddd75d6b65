// Ways for bodies that must turn where there is hardly room: poses instead of points.
#pragma once

#include <vector>

#include "planning/space.hpp"

namespace irsim {

/// A pose, and how it is reached from the one before.
struct Leg {
  Pose pose;
  int way;  // 1 forward, -1 backward, 0 by turning in place
};

struct PoseProblem {
  const Blockers& blockers;
  const Shapes& shapes;
  int object;  // whose footprint it is
  Box bounds;  // of positions
  Pose start;
  Vec2 goal;
  double near;    // the last pose is so near the goal [m]
  bool backs;     // may go backward
  double radius;  // of the turning circle [m]; 0: turns in place
  double reach;   // farthest point of the footprint from its origin [m]
  double room;    // radius of a disc about the origin within the footprint [m]
};

/// Legs from start to goal, the start first; empty if none are found. Hybrid A*: Dolgov, Thrun, Montemerlo, Diebel,
/// "Practical Search Techniques in Path Planning for Autonomous Driving" (2008): short arcs, or straight pieces and
/// turns in place, between poses of which one per cell of position and heading is kept.
std::vector<Leg> search_poses(const PoseProblem& problem);

}  // namespace irsim
