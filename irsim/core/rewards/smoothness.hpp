// How hard controls change.
#pragma once

#include "fields.hpp"
#include "rewarding.hpp"

namespace irsim {

struct SmoothnessOptions {
  enum Of { kChange, kTurning };
  Of of;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(choice("of", &SmoothnessOptions::of, "change", "turning"));
  }
};

/// The square, times the duration of the step [s].
inline double smoothness(const SmoothnessOptions& o, const LearnerStep& step) {
  if (o.of == SmoothnessOptions::kTurning) return step.step_time * step.yaw_rate * step.yaw_rate;
  double squares = 0.0;
  int usable = 0;
  for (int k = 0; k < 3; ++k) {
    const double extent = step.high[k] - step.low[k];
    if (!(std::isfinite(extent) && extent > 0.0)) continue;
    const double share = (step.control[k] - step.control_before[k]) / extent;
    squares += share * share;
    ++usable;
  }
  return step.step_time * (squares / std::max(usable, 1));
}

}  // namespace irsim
