// All planners.
#pragma once

#include "planners.gen.hpp"
#include "planning/problem.hpp"

namespace irsim {

/// Plan a path with the given planner.
Plan find_path(const Planner& planner, const Problem& problem);

}  // namespace irsim
