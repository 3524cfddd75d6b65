// Once for each learner that begins to collide.
#pragma once

#include <tuple>

#include "rewarding.hpp"

namespace irsim {

struct CollisionOptions {
  static constexpr auto fields() { return std::make_tuple(); }
};

inline double collision(const CollisionOptions&, const LearnerStep& step) { return step.collided ? 1.0 : 0.0; }

}  // namespace irsim
