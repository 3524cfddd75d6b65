// jps: the same paths as astar, found by jumping over cells that need no decision.
#pragma once

#include "fields.hpp"
#include "planning/grid_search.hpp"

namespace irsim {

struct JpsOptions {
  double resolution;  // cell size [m]; 0: as in the map
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("resolution", &JpsOptions::resolution));
  }
};

inline Plan jps(const JpsOptions& options, const Problem& problem) { return search_jumps(problem, options.resolution); }

}  // namespace irsim
