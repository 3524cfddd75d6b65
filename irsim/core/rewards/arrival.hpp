// Once for each learner that arrives.
#pragma once

#include "fields.hpp"
#include "rewarding.hpp"

namespace irsim {

struct ArrivalOptions {
  bool each;
  static constexpr auto fields() { return std::make_tuple(field("each", &ArrivalOptions::each)); }
};

inline double arrival(const ArrivalOptions& o, const LearnerStep& step) {
  return (o.each ? step.reached : step.arrived) ? 1.0 : 0.0;
}

}  // namespace irsim
