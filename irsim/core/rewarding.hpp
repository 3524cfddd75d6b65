// The input of a reward term: one step of one learner.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "geometry/vec.hpp"
#include "surroundings/gaps.hpp"

namespace irsim {

/// Measures how far the footprint of a row is from the others.
class GapMeter {
 public:
  GapMeter(const World& world, const State& state, int row, const std::vector<ObjectKind>& kinds)
      : world_(world), state_(state), row_(row), kinds_(kinds) {}

  /// The distance to the nearest footprint of some kinds [m], infinite above `reach`, negative for overlaps.
  double nearest(std::initializer_list<ObjectKind> of, double reach) {
    if (reach != reach_) gaps(world_, state_, row_, kinds_, reach, found_.data());
    reach_ = reach;
    double gap = kInfinity;
    for (const ObjectKind kind : of) gap = std::min(gap, found_[static_cast<int>(kind)]);
    return gap;
  }

 private:
  const World& world_;
  const State& state_;
  int row_;
  const std::vector<ObjectKind>& kinds_;
  double reach_ = -1.0;
  std::array<double, kKinds> found_{};
};

struct LearnerStep {
  double step_time;              // [s]
  Pose pose_before, pose;        // at the start and at the end of the step, world frame
  Pose goal;                     // at the start of the step; x is NaN without one
  bool reached;                  // whether it reached a goal: the last one, or one of several
  bool arrived, collided;        // whether it arrived, and whether it began to collide
  Vec3 control_before, control;  // executed in the step before, and in this one; zero padded
  Vec3 low, high;                // limits of the controls
  double yaw_rate;               // [rad/s]
  mutable GapMeter gap;

  /// The share of `margin` [m] that is missing to the nearest footprint of some kinds, 0 to 1.
  double missing_share(double margin, std::initializer_list<ObjectKind> of) const {
    return std::clamp((margin - gap.nearest(of, margin)) / margin, 0.0, 1.0);
  }
};

}  // namespace irsim
