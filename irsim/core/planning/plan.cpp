#include "planning/plan.hpp"

#include "fields.hpp"

namespace irsim {

Plan find_path(const Planner& planner, const Problem& problem) {
  Plan plan;
  with(planner, [&](const auto& options) { plan = run(options, problem); });
  return plan;
}

}  // namespace irsim
