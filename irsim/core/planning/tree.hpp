// Rapidly exploring random trees. LaValle, Kuffner: Randomized Kinodynamic Planning (2001); Karaman, Frazzoli:
// Sampling-based algorithms for optimal motion planning (2011); Gammell, Srinivasa, Barfoot: Informed RRT* (2014).
#pragma once

#include "planning/problem.hpp"

namespace irsim {

struct TreeOptions {
  double expand_dis;           // longest extension [m]
  double path_resolution;      // lengths of extensions are multiples of it [m]
  double goal_sample_rate;     // share of samples that are the goal [%]
  int max_iter;                // largest number of samples
  bool rewire;                 // whether new nodes choose the best parent and replace longer paths of other nodes
  double connect_circle_dist;  // factor of the radius in which nodes are rewired [m]
  bool search_until_max_iter;  // whether the search continues after the first path
  bool informed;               // whether samples after the first path are limited to places of shorter ones
};

Plan grow_tree(const Problem& problem, const TreeOptions& options);

}  // namespace irsim
