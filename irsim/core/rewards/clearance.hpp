// How far a learner is inside a margin around others.
#pragma once

#include "fields.hpp"
#include "rewarding.hpp"

namespace irsim {

struct ClearanceOptions {
  enum To { kAll, kRobots, kObstacles };
  double margin;  // [m]
  To to;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using O = ClearanceOptions;
    return visit(field("margin", &O::margin), choice("to", &O::to, "all", "robots", "obstacles"));
  }
};

/// The missing share of the margin, times the duration of the step [s].
inline double clearance(const ClearanceOptions& o, const LearnerStep& step) {
  using K = ObjectKind;
  if (o.to == ClearanceOptions::kRobots) return step.step_time * step.missing_share(o.margin, {K::robot});
  if (o.to == ClearanceOptions::kObstacles) return step.step_time * step.missing_share(o.margin, {K::human, K::fixed});
  return step.step_time * step.missing_share(o.margin, {K::robot, K::human, K::fixed});
}

}  // namespace irsim
