// What stands still, as ORCA sees it: the edges of walls and discs.
#pragma once

#include <vector>

#include "collision/grid.hpp"
#include "orca/constraints.hpp"

namespace irsim {

struct Fixed;
struct Shapes;
struct World;

/// A circle that stands still, world frame.
struct StandingDisc {
  Vec2 centre;
  double radius;  // [m]
  int object;
};

/// All of one scene but what is `unobstructed`. Open lines have an edge on either side.
struct Obstacles {
  std::vector<Edge> edges;
  std::vector<StandingDisc> discs;
  Grid grid;  // of edges, then discs

  bool empty() const { return edges.empty() && discs.empty(); }
  /// Calls `visit(k)` for those whose box meets `box`, in no particular order; edge k, or disc k - edges.size().
  template <class Visit>
  void near(const Box& box, Visit&& visit) const {
    const std::size_t count = edges.size() + discs.size();
    if (count > kFew) return grid.query(box, visit);
    for (std::size_t k = 0; k < count; ++k) visit(static_cast<int>(k));
  }

 private:
  static constexpr std::size_t kFew = 16;
};

/// After the walls and lines of `fixed` have been made.
Obstacles make_obstacles(const World& world, const Shapes& shapes, const Fixed& fixed);

}  // namespace irsim
