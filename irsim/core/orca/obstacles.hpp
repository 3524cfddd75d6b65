// Static obstacles as ORCA sees them: edges of walls, and discs.
#pragma once

#include <vector>

#include "collision/grid.hpp"
#include "orca/constraints.hpp"

namespace irsim {

struct Fixed;
struct Shapes;
struct World;

/// A static circle, world frame.
struct StaticDisc {
  Vec2 centre;
  double radius;  // [m]
  int object;
};

/// All static obstacles of one scene. Open lines have an edge on either side.
struct Obstacles {
  std::vector<Edge> edges;
  std::vector<StaticDisc> discs;
  Grid grid;  // boxes of edges, then of discs

  bool empty() const { return edges.empty() && discs.empty(); }
  /// Call `visit(k)` for the obstacles whose box meets `box`, in no particular order: edge k, or disc k - edges.size().
  template <class Visit>
  void near(const Box& box, Visit&& visit) const {
    const std::size_t count = edges.size() + discs.size();
    if (count > kMaxLinearObstacles) return grid.query(box, visit);
    for (std::size_t k = 0; k < count; ++k) visit(static_cast<int>(k));
  }

 private:
  static constexpr std::size_t kMaxLinearObstacles = 16;  // up to this many are visited one by one
};

/// Make the obstacles from the walls, lines and discs of `fixed`.
Obstacles make_obstacles(const World& world, const Shapes& shapes, const Fixed& fixed);

}  // namespace irsim
