// Once for each learner that begins to collide.
#pragma once

#include <tuple>

#include "rewarding.hpp"

namespace irsim {

struct CollisionOptions {
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit();
  }
};

inline double collision(const CollisionOptions&, const LearnerStep& step) { return step.collided ? 1.0 : 0.0; }

}  // namespace irsim
