// astar: the shortest path over the eight neighbours of each cell.
#pragma once

#include "fields.hpp"
#include "planning/grid_search.hpp"

namespace irsim {

struct AstarOptions {
  double resolution;  // cell size [m]; 0: as in the map
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("resolution", &AstarOptions::resolution));
  }
};

inline Plan astar(const AstarOptions& options, const Problem& problem) {
  return search_astar(problem, options.resolution);
}

}  // namespace irsim
