// Rapidly exploring random trees. LaValle, Kuffner: Randomized Kinodynamic Planning (2001); Karaman, Frazzoli:
// Sampling-based algorithms for optimal motion planning (2011); Gammell, Srinivasa, Barfoot: Informed RRT* (2014).
#pragma once

#include "planning/problem.hpp"

namespace irsim {

struct TreeOptions {
  double expand_dis;        // longest extension [m]
  double path_resolution;   // extensions end on multiples of it [m]
  double goal_sample_rate;  // share of samples that are the goal [%]
  int max_iter;             // samples
  bool rewire;              // choose the best parent, and become one where that is shorter
  double connect_circle_dist;
  bool search_until_max_iter;
  bool informed;  // once there is a path, sample only where a shorter one can be
};

Plan grow_tree(const Problem& problem, const TreeOptions& options);

}  // namespace irsim
