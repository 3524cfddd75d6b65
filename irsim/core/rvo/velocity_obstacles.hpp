// Velocity obstacles: velocities that lead to collisions, and the best velocity of a grid outside all of them.
#pragma once

#include <vector>

#include "geometry/vec.hpp"
#include "surroundings/wall_view.hpp"

namespace irsim {

/// Velocities w with cross(left, w - apex) <= 0 <= cross(right, w - apex): the velocities that lead to a collision.
struct Cone {
  Vec2 apex, left, right;  // [m/s]; unit vectors

  bool blocks(Vec2 w) const { return under_left(w) && over_right(w); }
  bool under_left(Vec2 w) const { return left.x * (w.y - apex.y) - left.y * (w.x - apex.x) <= 0.0; }
  bool over_right(Vec2 w) const { return right.x * (w.y - apex.y) - right.y * (w.x - apex.x) >= 0.0; }
};

/// The facts about a disc that the penalty needs. The time to reach it at velocity w is gap / ||2 w - sum||.
struct Approach {
  Vec2 sum;         // sum of both velocities [m/s]
  double gap;       // length of the tangent to the disc [m]; 0 inside
  double inverse2;  // 1 / gap^2
};

/// A segment of a linestring relative to the ego.
struct Stretch {
  Vec2 a, along;          // one end relative to the ego [m], unit vector to the other
  double length, radius;  // [m]
  /// Time until the ego is within `radius` of the line at velocity w [s]; kNever if that does not happen between its
  /// ends.
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

/// Everything that one object has to avoid; scratch memory.
struct VelocityObstacles {
  std::vector<Cone> cones;
  std::vector<Approach> approaches;
  std::vector<Stretch> stretches;
  WallView walls;
  double horizon = 0;      // a wall blocks velocities that reach it sooner [s]
  double look_share = 0;   // part of Front::look within which walls that can be passed block directions
  std::vector<Cone> ways;  // scratch: `cones`, and the cones of walls whose every direction is blocked

  void clear();
  bool walled(Vec2 w) const { return walls.blocks(w, horizon, look_share); }
};

/// The sample of the grid nearest to `desired` outside all obstacles; among equally near ones the first by x, then y.
/// If every sample is blocked, the one with the smallest penalty, which is `factor` divided by the time to the first
/// collision plus the distance to `desired`. Samples that hit walls count only if no sample avoids them.
///
/// Walls that can be passed block every direction that meets them within Front::look, so that the sample leads past
/// them. If no such sample leads nearer to `desired`, half of that distance counts, and so on; in the end they block
/// only what reaches them before `horizon`, as walls that cannot be passed do.
Vec2 best_sample(VelocityObstacles& obstacles, const Axis& x, const Axis& y, Vec2 desired, double factor);

}  // namespace irsim
