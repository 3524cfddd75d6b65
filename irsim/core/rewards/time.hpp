// Seconds that pass.
#pragma once

#include <tuple>

#include "rewarding.hpp"

namespace irsim {

struct TimeOptions {
  static constexpr auto fields() { return std::make_tuple(); }
};

inline double time(const TimeOptions&, const LearnerStep& step) { return step.step_time; }

}  // namespace irsim
