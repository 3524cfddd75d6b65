// Once for each learner that arrives.
#pragma once

#include "fields.hpp"
#include "rewarding.hpp"

namespace irsim {

struct ArrivalOptions {
  bool each;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("each", &ArrivalOptions::each));
  }
};

inline double arrival(const ArrivalOptions& o, const LearnerStep& step) {
  return (o.each ? step.reached : step.arrived) ? 1.0 : 0.0;
}

}  // namespace irsim
