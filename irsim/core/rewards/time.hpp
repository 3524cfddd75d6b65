// Seconds that pass.
#pragma once

#include <tuple>

#include "rewarding.hpp"

namespace irsim {

struct TimeOptions {
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit();
  }
};

inline double time(const TimeOptions&, const LearnerStep& step) { return step.step_time; }

}  // namespace irsim
