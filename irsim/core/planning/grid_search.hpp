// Shortest paths over the eight neighbors of each open cell. No step cuts the corner of a closed cell.
#pragma once

#include "planning/problem.hpp"

namespace irsim {

/// Cells of size `resolution` [m]. If that is 0, the cells of the map, or cells of 0.1 m without a map.
Lattice lattice_for(const Problem& problem, double resolution);

/// A*. Hart, Nilsson, Raphael: A Formal Basis for the Heuristic Determination of Minimum Cost Paths (1968).
Plan search_astar(const Problem& problem, double resolution);
/// Jump point search in the variant that cuts no corners. Harabor, Grastien: Online Graph Pruning for Pathfinding on
/// Grid Maps (AAAI 2011).
Plan search_jumps(const Problem& problem, double resolution);

}  // namespace irsim
