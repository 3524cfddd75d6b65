// Where a body may be: obstacles, and the rectangle that it must not leave.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "collision/grid.hpp"
#include "planning/body.hpp"

namespace irsim {

/// Static obstacles of a planner. Ids are rows of `shapes`.
struct Blockers {
  const Shapes& shapes;
  const Outlines& outlines;
  const Grid& grid;
  const std::uint8_t* passable;                    // (N,) 1 for objects that are not obstacles; null if all are
  const std::vector<Footprint>* others = nullptr;  // more obstacles, or null

  bool counts(int id) const { return passable == nullptr || !passable[id]; }
  bool meet(const Footprint& body) const;
  /// Distance from a body to the nearest static obstacle, or `most` if that is smaller [m]; negative if they overlap.
  double gap(const Footprint& body, double most) const;
};

/// Obstacles with geometry of their own, for maps that Python assembles.
class Terrain {
 public:
  explicit Terrain(const Box& bounds) : bounds_(bounds) {}
  /// Add outlines in the body frame at a pose; unknown cells of maps are obstacles, too. Queries are possible after
  /// `build`.
  void add(const std::vector<Outline>& outlines, const Pose& pose);
  void build();

  Blockers blockers() const { return {shapes_, outlines_, grid_, nullptr, nullptr}; }
  const Box& bounds() const { return bounds_; }

 private:
  Box bounds_;
  Shapes shapes_;
  std::vector<Pose> poses_;
  Outlines outlines_;
  Grid grid_;
};

/// An area that positions must not leave.
class Region {
 public:
  /// `corners`: x and y of at least three corners, in order [m].
  explicit Region(const std::vector<std::vector<double>>& corners);
  bool holds(Vec2 p) const;
  /// Whether a straight line stays within; one that starts outside may come in once.
  bool keeps(Vec2 a, Vec2 b) const;
  /// The box around it.
  Box box() const;

 private:
  std::vector<Vec2> ring_;  // the last corner is the first again
};

/// One body among obstacles.
struct Space {
  const Blockers& blockers;
  Body& body;
  Box bounds;  // positions (footprints if `enclosed`) outside are not free
  bool enclosed;
  const Region* region = nullptr;  // area that positions must not leave, or null

  bool inside(Vec2 p) const;
  /// Whether the body may be at p.
  bool free(Vec2 p) const { return inside(p) && !blockers.meet(body.at(p)); }
  /// Whether the body may move from a, where it may be, straight to b.
  bool clear(Vec2 a, Vec2 b) const {
    return inside(b) && (region == nullptr || region->keeps(a, b)) && !blockers.meet(body.swept(a, b));
  }
};

}  // namespace irsim
