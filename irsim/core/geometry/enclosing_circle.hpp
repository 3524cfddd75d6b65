// Smallest circle around points and discs.
#pragma once

#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

struct PlainDisc {
  Vec2 centre;
  double radius = 0.0;
};

/// The smallest circle that contains all discs (points are discs of radius 0).
PlainDisc enclosing_circle(const std::vector<PlainDisc>& discs);

}  // namespace irsim
