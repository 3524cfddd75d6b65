// Metres that a learner has come nearer to its goal.
#pragma once

#include <tuple>

#include "rewarding.hpp"

namespace irsim {

struct ProgressOptions {
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit();
  }
};

/// 0 without a goal.
inline double progress(const ProgressOptions&, const LearnerStep& step) {
  const Vec2 goal = step.goal.position();
  const double gained = norm(goal - step.pose_before.position()) - norm(goal - step.pose.position());
  return std::isfinite(gained) ? gained : 0.0;
}

}  // namespace irsim
