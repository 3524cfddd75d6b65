// How many walls a straight line passes.
#pragma once

#include "geometry/shapes.hpp"

namespace irsim {

/// Number of walls and solid bodies of a footprint between two points: lines count each time they are crossed, and
/// solid areas once each time the way leads through them.
int crossings(const Footprint& body, Vec2 from, Vec2 to);

}  // namespace irsim
