// Velocities allowed by half-planes: the linear programs of ORCA (van den Berg, Guy, Lin, Manocha 2011, section 5).
#pragma once

#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

/// Velocities on the left of a directed line [m/s].
struct HalfPlane {
  Vec2 point, direction;  // direction: unit vector

  /// How far `v` is inside; negative outside.
  double depth(Vec2 v) const { return cross(direction, v - point); }
};

/// The velocity nearest to `preferred`, at most `max_speed` long, in all of `planes`; where there is none, the one that
/// is least outside, with the first `hard` of them kept.
///
/// Args:
///   planes: (count,) half-planes; zero velocity is in each of the first `hard`.
///   scratch: Memory.
///   velocity: Where the answer goes [m/s].
/// Returns: Whether some velocity is in all of them.
bool choose_velocity(const HalfPlane* planes, int count, int hard, double max_speed, Vec2 preferred,
                     std::vector<HalfPlane>& scratch, Vec2& velocity);

}  // namespace irsim
