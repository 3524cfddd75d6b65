// Paths of poses instead of points, for bodies that must turn in narrow places.
#pragma once

#include <vector>

#include "planning/space.hpp"

namespace irsim {

/// A pose and how it is reached from the pose before it.
struct Leg {
  Pose pose;
  int way;  // 1 forward, -1 backward, 0 by turning on the spot
};

constexpr int kMaxPoses = 60000;  // poses after which the search for a plan gives up

/// The task of the planner.
struct PoseProblem {
  const Blockers& blockers;
  const Shapes& shapes;
  int object;  // object whose footprint moves
  Box bounds;  // limits of positions
  Pose start;
  Vec2 goal;
  double goal_heading;   // heading of a car at the goal, which it then reaches exactly [rad]; NaN: any
  double near;           // distance from the goal at which a path may end [m]
  bool backs;            // whether it may go backward
  double radius;         // radius of the turning circle [m]; 0 if it turns on the spot
  double reach;          // farthest point of the footprint from its origin [m]
  double room;           // radius of a disc about the origin within the footprint [m]
  const Region* region;  // area that positions must not leave, or null
  int most;              // number of poses after which the search gives up
};

/// Legs from start to goal, starting with the start; empty if none are found. Hybrid A* (Dolgov, Thrun, Montemerlo,
/// Diebel: "Practical Search Techniques in Path Planning for Autonomous Driving", 2008) with short arcs, or with
/// straight pieces and turns on the spot. One pose is kept for each cell of position and heading. A car that must reach
/// a heading goes the last part without changing between forward and backward (dubins.hpp).
std::vector<Leg> search_poses(const PoseProblem& problem);

}  // namespace irsim
