// Where a body may be: what stands in the way, and the rectangle it must stay in.
#pragma once

#include <cstdint>
#include <memory>

#include "collision/grid.hpp"
#include "planning/body.hpp"

namespace irsim {

/// Things that stand still, looked at from a planner. Ids are those of `shapes`.
struct Blockers {
  const Shapes& shapes;
  const Outlines& outlines;
  const Grid& grid;
  const std::uint8_t* passable;  // (N,) things that are no obstacle, or null

  bool counts(int id) const { return passable == nullptr || !passable[id]; }
  bool meet(const Footprint& body) const;
};

/// Obstacles of its own, for maps that Python puts together.
class Terrain {
 public:
  explicit Terrain(const Box& bounds) : bounds_(bounds) {}
  /// Outlines in the body frame, and where they stand. Questions are possible after `build`.
  void add(const std::vector<Outline>& outlines, const Pose& pose);
  void build();

  Blockers blockers() const { return {shapes_, outlines_, grid_, nullptr}; }
  const Box& bounds() const { return bounds_; }

 private:
  Box bounds_;
  Shapes shapes_;
  std::vector<Pose> poses_;
  Outlines outlines_;
  Grid grid_;
};

/// One body among obstacles.
struct Space {
  const Blockers& blockers;
  Body& body;
  Box bounds;  // positions (or, if `enclosed`, footprints) outside are not free
  bool enclosed;

  bool inside(Vec2 p) const;
  /// Whether the body may be at p.
  bool free(Vec2 p) const { return inside(p) && !blockers.meet(body.at(p)); }
  /// Whether the body may move from a, where it may be, straight to b.
  bool clear(Vec2 a, Vec2 b) const { return inside(b) && !blockers.meet(body.swept(a, b)); }
};

}  // namespace irsim
