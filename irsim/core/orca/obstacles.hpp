// Static obstacles as ORCA sees them: edges of walls, and discs.
#pragma once

#include <vector>

#include "collision/grid.hpp"
#include "orca/constraints.hpp"
#include "surroundings/walls.hpp"

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

/// Tells which edges can be seen from a point. The walls that edges were made from know which side a ring hides.
class Sight {
 public:
  Sight(const Walls& walls, Vec2 from) : walls_(walls), from_(from) {}

  bool sees(const Edge& edge) {
    if (!edge.faces(from_)) return false;
    if (edge.ring < 0) return true;
    if (edge.ring != ring_) ring_ = edge.ring, seen_ = walls_.rings[ring_].is_seen_from(from_);
    return seen_;
  }

 private:
  const Walls& walls_;
  Vec2 from_;
  int ring_ = -1;
  bool seen_ = false;
};

/// All static obstacles of one scene.
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

/// Make the obstacles from the walls and discs of `fixed`.
Obstacles make_obstacles(const World& world, const Shapes& shapes, const Fixed& fixed);

}  // namespace irsim
