// Space that belongs to one body for the next step: bodies that stay in their own space cannot touch.
#pragma once

#include <vector>

#include "footprints/hulls.hpp"

namespace irsim {

/// A line that a body must not cross in the next step.
struct Border {
  Vec2 axis;     // unit vector into the space of the body
  double limit;  // smallest dot product of `axis` with its hull, without rounding [m]
};

/// The border between two bodies that both stay in their own space.
///
/// They divide the gap between them along the axis that both find, in proportion to their speeds toward each other,
/// which both know. Each may use its part however it moves, as in buffered Voronoi cells (Zhou, Wang, Bandyopadhyay,
/// Schwager: Fast, on-line collision avoidance for dynamic vehicles using buffered Voronoi cells, 2017).
///
/// Args:
///   own, other: Speeds toward each other along the axis, at least 0 [m/s].
///   margin: Part of the gap that stays free [m].
Border border(const Hull& body, const Separation& apart, double own, double other, double margin);

/// The space of one body.
struct FreeCell {
  struct Fixture {
    Hull hull;
    double gap;  // least distance [m]
    Vec2 shift;  // of the hull until the end of the step [m]
  };
  std::vector<Border> borders;
  std::vector<Fixture> fixtures;  // bodies that stand, or move on whatever this one does
  std::vector<Vec2> moved;        // scratch memory

  void clear() { borders.clear(), fixtures.clear(); }
  bool empty() const { return borders.empty() && fixtures.empty(); }
  /// The smallest amount by which a body stays within the cell after it has moved [m]; negative if it leaves it.
  ///
  /// Args:
  ///   place: Position of the body before [m].
  ///   shift: Change of the position [m].
  ///   turn: Cosine and sine of the change of heading.
  double room(const Hull& body, Vec2 place, Vec2 shift, Vec2 turn);
};

}  // namespace irsim
