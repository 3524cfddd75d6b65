// The surfaces that beams hit: which way they face.
#pragma once

#include "sensing.hpp"
#include "sensing/raycast.hpp"

namespace irsim {

/// Looks up the surfaces of one scan. Neighboring beams mostly hit the same edge, which is tried first.
class Surface {
 public:
  explicit Surface(const Sensing& sensing) : sensing_(sensing) {}

  /// Unit normal, world frame, of the surface that beam i of a fan hits; either of the two directions. The cells of
  /// maps are steps of what they stand for: there it is the normal of the line through the hits of the neighboring
  /// beams.
  Vec2 normal(const Fan& fan, int i);
  /// Cosine of the incidence of beam i, 0 to 1: 1 from straight ahead.
  double cosine(const Fan& fan, int i) { return std::fabs(dot(normal(fan, i), fan.beam(i))); }

 private:
  Vec2 normal_of_cells(const OccupancyGrid& grid, const Fan& fan, int i) const;

  const Sensing& sensing_;
  int object_ = -1;             // whose edge was hit last; -1: none
  Vec2 from_, along_, normal_;  // of that edge
};

}  // namespace irsim
