// The half-planes of ORCA: which velocities avoid one other agent, or one wall, for some time.
#pragma once

#include "geometry/vec.hpp"
#include "orca/half_planes.hpp"

namespace irsim {

/// Who moves: a disc, world frame.
struct OrcaAgent {
  Vec2 position, velocity;  // [m], [m/s]
  double radius;            // margin included [m]
};

/// Where two edges of an outline meet, or where an open line ends; its solid side is on the left.
struct Corner {
  Vec2 point;          // [m], world frame
  Vec2 in, out;        // unit vectors of the edges that end and start here
  bool convex = true;  // the solid side spans at most half a turn
};

/// An edge of what stands still: `left` to `right` as seen from the free side, solid behind it.
struct Edge {
  Corner left, right;
  int object;

  Vec2 direction() const { return left.out; }
  /// Whether `p` is on the free side.
  bool faces(Vec2 p) const { return cross(direction(), p - left.point) < 0.0; }
};

/// Velocities with which `agent` meets `other` not before `horizon` [s], if it takes `share` of the smallest change
/// and `other` the rest. Who overlaps shall be apart after `dt`.
///
/// Args:
///   first: Which of two agents in one place with one velocity goes to which side.
HalfPlane avoid_agent(const OrcaAgent& agent, const OrcaAgent& other, double share, double horizon, double dt,
                      bool first);

/// Velocities with which `agent` does not meet a disc that stands still before `horizon` [s]; zero is one of them.
HalfPlane avoid_disc(const OrcaAgent& agent, Vec2 centre, double radius, double horizon);

/// Velocities with which `agent` does not meet an edge before `horizon` [s]; zero is one of them. False when a
/// neighbouring edge says all there is to say.
bool avoid_edge(const OrcaAgent& agent, const Edge& edge, double horizon, HalfPlane& out);

/// Whether `plane` forbids every velocity that meets the capsule between `a` and `b` of this radius before `horizon`.
inline bool covers(const HalfPlane& plane, const OrcaAgent& agent, Vec2 a, Vec2 b, double radius, double horizon) {
  constexpr double kSlack = 1e-5;
  const double rate = 1.0 / horizon;
  const double reach = -(rate * radius - kSlack);
  return plane.depth((a - agent.position) * rate) <= reach && plane.depth((b - agent.position) * rate) <= reach;
}

}  // namespace irsim
