// The half-planes of ORCA: velocities that avoid another agent, a disc or a wall for some time.
#pragma once

#include "geometry/vec.hpp"
#include "orca/half_planes.hpp"

namespace irsim {

/// A moving disc, world frame.
struct OrcaAgent {
  Vec2 position, velocity;  // [m], [m/s]
  double radius;            // including the margin [m]
};

/// The point at which two edges of an outline meet. The solid side is on the left.
struct Corner {
  Vec2 point;          // [m], world frame
  Vec2 in, out;        // unit vectors of the edges that end and start at this corner
  bool convex = true;  // whether the solid side spans at most half a turn
};

/// An edge of a static object, from `left` to `right` as seen from the free side.
struct Edge {
  Corner left, right;
  int object;
  int ring = -1;  // index in Walls::rings if this hides the edge from one side of it, else -1

  Vec2 direction() const { return left.out; }
  /// Whether `p` is on the free side.
  bool faces(Vec2 p) const { return cross(direction(), p - left.point) < 0.0; }
};

/// Velocities with which `agent` does not meet `other` before `horizon` [s] if it makes `share` of the smallest change
/// of velocity and `other` makes the rest. Agents that overlap are to be apart after `dt` [s].
///
/// Args:
///   first: Whether this is the first of the two in the file. It decides the direction only for agents with equal
///   positions and velocities, which nothing else tells apart.
///   plane: The result.
void avoid_agent(const OrcaAgent& agent, const OrcaAgent& other, double share, double horizon, double dt, bool first,
                 HalfPlane& plane);

/// Velocities with which `agent` does not meet a static disc before `horizon` [s]. They include zero.
HalfPlane avoid_disc(const OrcaAgent& agent, Vec2 centre, double radius, double horizon);

/// Velocities with which `agent` does not meet an edge before `horizon` [s]. They include zero. Returns false if the
/// half-plane of a neighboring edge is sufficient.
bool avoid_edge(const OrcaAgent& agent, const Edge& edge, double horizon, HalfPlane& out);

/// Whether `plane` excludes all velocities with which `agent` meets the capsule of this radius between `a` and `b`
/// before `horizon`.
inline bool covers(const HalfPlane& plane, const OrcaAgent& agent, Vec2 a, Vec2 b, double radius, double horizon) {
  constexpr double kSlack = 1e-5;
  const double rate = 1.0 / horizon;
  const double reach = -(rate * radius - kSlack);
  return plane.depth((a - agent.position) * rate) <= reach && plane.depth((b - agent.position) * rate) <= reach;
}

}  // namespace irsim
