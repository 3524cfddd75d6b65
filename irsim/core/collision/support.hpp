// How far a footprint reaches in a direction.
#pragma once

#include "geometry/shapes.hpp"

namespace irsim {

/// Largest dot product of a unit vector with a point of a footprint [m].
double support(const Footprint& body, Vec2 direction);

/// How far a footprint reaches from a place in the direction of a unit vector [m].
inline double reach_from(const Footprint& body, Vec2 place, Vec2 direction) {
  return support(body, direction) - dot(place, direction);
}

}  // namespace irsim
