// Velocities allowed by half-planes: the linear programs of ORCA (van den Berg, Guy, Lin, Manocha 2011, section 5).
#pragma once

#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

/// Velocities on the left of a directed line [m/s].
struct HalfPlane {
  Vec2 point, direction;  // direction: unit vector

  /// Distance of `v` from the line; negative outside of the half-plane.
  double depth(Vec2 v) const { return cross(direction, v - point); }
};

/// Find the velocity nearest to `preferred`, at most `max_speed` long, within all `planes`. If no velocity is, find the
/// one with the smallest violation that still satisfies the first `hard` planes.
///
/// Args:
///   planes: (count,) half-planes; zero velocity is in each of the first `hard`.
///   scratch: Scratch memory.
///   velocity: The result [m/s].
/// Returns: Whether the velocity is within all planes.
bool choose_velocity(const HalfPlane* planes, int count, int hard, double max_speed, Vec2 preferred,
                     std::vector<HalfPlane>& scratch, Vec2& velocity);

}  // namespace irsim
