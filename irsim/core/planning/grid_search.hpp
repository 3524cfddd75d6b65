// Shortest paths over the eight neighbours of each open cell; no step cuts the corner of a closed one.
#pragma once

#include "planning/problem.hpp"

namespace irsim {

/// Cells of size `resolution` [m], or of the map's own (0.1 m without) if it is 0.
Lattice lattice_for(const Problem& problem, double resolution);

/// A*. Hart, Nilsson, Raphael: A Formal Basis for the Heuristic Determination of Minimum Cost Paths (1968).
Plan search_astar(const Problem& problem, double resolution);
/// Jump point search, the variant that cuts no corners. Harabor, Grastien: Online Graph Pruning for Pathfinding on Grid
/// Maps (AAAI 2011).
Plan search_jumps(const Problem& problem, double resolution);

}  // namespace irsim
