// Velocities that lead into others, and the best of a grid of velocities that does not.
#pragma once

#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

/// Velocities w with cross(left, w - apex) <= 0 <= cross(right, w - apex): those that lead into somebody.
struct Cone {
  Vec2 apex, left, right;  // [m/s]; unit vectors

  bool blocks(Vec2 w) const { return under_left(w) && over_right(w); }
  bool under_left(Vec2 w) const { return left.x * (w.y - apex.y) - left.y * (w.x - apex.x) <= 0.0; }
  bool over_right(Vec2 w) const { return right.x * (w.y - apex.y) - right.y * (w.x - apex.x) >= 0.0; }
};

/// What the penalty reads of a disc: the time to reach it at velocity w is gap / ||2 w - sum||.
struct Approach {
  Vec2 sum;         // of both velocities [m/s]
  double gap;       // length of the tangent to the disc [m], 0 inside
  double inverse2;  // 1 / gap^2
};

/// A segment of a linestring, seen from the ego.
struct Stretch {
  Vec2 a, along;          // one end relative to the ego [m], unit vector to the other
  double length, radius;  // [m]
  /// When the ego comes so near the line if it moves at w [s]; kNever if it does not, or beyond the ends.
  double time(Vec2 w) const;
};

/// A wall, seen from the ego.
struct Barrier {
  Vec2 a, b, nearest;  // relative to the ego [m]
  double radius, gap;  // of the ego; distance of its rim from the wall [m], negative inside
  /// When the rim reaches the wall at velocity w [s]: 0 if it is there and does not go away, infinite if never.
  double time(Vec2 w) const;
};

constexpr double kNever = 1e6;  // stands for "no collision" in the penalty [s]

/// Values of numpy.arange(start, stop, spacing).
struct Axis {
  double first = 0, spacing = 1;
  int count = 0;

  static Axis arange(double start, double stop, double spacing);
  double at(int i) const { return first + i * spacing; }
  /// Index of the value nearest to v.
  int nearest(double v) const;
};

/// All that one object has to avoid; scratch memory.
struct VelocityObstacles {
  std::vector<Cone> cones;
  std::vector<Approach> approaches;
  std::vector<Stretch> stretches;
  std::vector<Barrier> barriers;
  double horizon = 0;  // a wall is in the way if it is reached sooner [s]

  void clear();
  bool walled(Vec2 w) const;
};

/// The sample of the grid nearest to `desired` that nothing blocks, the first in order of x, then y, of equally near
/// ones. Where everything is blocked, the one with the least penalty: `factor` divided by the time to the first
/// collision plus the distance to `desired`; walls are not entered if any sample avoids them.
Vec2 best_sample(VelocityObstacles& obstacles, const Axis& x, const Axis& y, Vec2 desired, double factor);

}  // namespace irsim
