// A row of discs along a long body, which covers it more closely than its bounding circle.
#pragma once

#include "geometry/shapes.hpp"

namespace irsim {

/// Discs of equal radius that cover a body, body frame.
struct BodyDiscs {
  static constexpr int kMost = 5;
  int count = 0;
  Vec2 centres[kMost];
  double radius = 0.0;  // [m]
};

/// The discs of an object: its bounding circle unless it is long.
BodyDiscs body_discs(const Shapes& shapes, int object);

}  // namespace irsim
