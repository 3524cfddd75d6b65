// Velocity obstacles of convex bodies with their true outlines.
#pragma once

#include <vector>

#include "footprints/hulls.hpp"

namespace irsim {

/// A line that separates two bodies now.
struct Face {
  Vec2 axis;   // unit vector from b to a
  double gap;  // [m], positive
};

/// The velocity obstacle of two convex bodies that do not turn: relative velocities between the tangents of their
/// Minkowski difference lead to a collision (Fiorini, Shiller: Motion planning in dynamic environments using velocity
/// obstacles, 1998).
struct VelocityCone {
  Vec2 left, right;  // unit vectors along the tangents, seen from a
  int first, count;  // faces that a collision must close

  /// Time until two bodies with this relative velocity collide [s]; infinite if they never do.
  double time(Vec2 velocity, const Face* faces) const {
    if (!(cross(left, velocity) < 0.0 && cross(right, velocity) > 0.0)) return kInfinity;
    double latest = 0.0;
    for (int k = first; k < first + count; ++k) {
      const double closing = -dot(faces[k].axis, velocity);
      if (!(closing > 0.0)) return kInfinity;
      if (faces[k].gap > latest * closing) latest = faces[k].gap / closing;
    }
    return latest;
  }
};

/// Find the cone of two hulls, and how they are apart. Its faces are appended to `faces`.
///
/// Args:
///   margin: Distance to keep, as far as they keep it now [m].
///   mirrored: Swap the bodies in the computation, not in the result. Two objects that look at each other with opposite
///   values find the same axis to the last bit.
Separation cone_of(const Hull& a, const Hull& b, double margin, bool mirrored, std::vector<Face>& faces,
                   VelocityCone& cone);

/// Find the cone of two discs that are apart, with `offset` from a to b and the sum of their radii.
void cone_of(Vec2 offset, double radius, std::vector<Face>& faces, VelocityCone& cone);

}  // namespace irsim
