// All planners, and asking one of them.
#pragma once

#include "planners.gen.hpp"
#include "planning/problem.hpp"

namespace irsim {

Plan find_path(const Planner& planner, const Problem& problem);

}  // namespace irsim
