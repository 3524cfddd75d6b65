// How far a learner comes into the personal space of people.
#pragma once

#include "fields.hpp"
#include "rewarding.hpp"

namespace irsim {

struct SocialOptions {
  double distance;  // [m]
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("distance", &SocialOptions::distance));
  }
};

/// The missing share of the distance, times the duration of the step [s].
inline double social(const SocialOptions& o, const LearnerStep& step) {
  return step.step_time * step.missing_share(o.distance, {ObjectKind::human});
}

}  // namespace irsim
