// Space that belongs to one body until it stands: bodies that stay in their own space cannot touch.
#pragma once

#include <vector>

#include "footprints/hulls.hpp"
#include "footprints/manoeuvres.hpp"

namespace irsim {

/// A line that a body must not cross.
struct Border {
  Vec2 axis;       // unit vector into the space of the body
  double limit;    // smallest dot product of `axis` with its hull at the ends of steps [m]
  double reserve;  // how far it may go beyond that between the ends of steps [m]
};

/// The border between two bodies that both stay in their own space.
///
/// They divide the gap between the hulls of their stops along the axis that both find, in proportion to their speeds
/// toward each other, which both know. Each may use its part however it moves, as in buffered Voronoi cells (Zhou,
/// Wang, Bandyopadhyay, Schwager: Fast, on-line collision avoidance for dynamic vehicles using buffered Voronoi cells,
/// 2017), and each can always stop in its part.
///
/// Args:
///   stop: The hull of all places until the body has stopped, if it brakes now.
///   own, other: Speeds toward each other along the axis, at least 0 [m/s].
///   margin: Part of the gap that stays free [m].
Border border(const Hull& stop, const Separation& apart, double own, double other, double margin);

/// The body whose cell it is.
struct CellBody {
  Hull hull;
  Vec2 position;
};

/// The space of one body.
struct FreeCell {
  struct Fixture {
    Hull hull;
    double gap;   // least distance [m]
    double now;   // present distance [m]
    Vec2 shift;   // of the hull in this step [m]
    bool stands;  // whether it is certain to be there: others may be elsewhere
  };
  std::vector<Border> borders;
  std::vector<Fixture> fixtures;  // bodies that stand, or move on whatever this one does
  std::vector<Vec2> moved;        // scratch memory

  void clear() { borders.clear(), fixtures.clear(); }
  bool empty() const { return borders.empty() && fixtures.empty(); }
  /// Whether a body stays on its side of all borders, and off what stands.
  bool holds(const CellBody& body, const Manoeuvre& way);
  /// The smallest amount by which a body keeps its distance from what may be elsewhere, in this step [m]; negative if
  /// it does not.
  double room(const CellBody& body, const Manoeuvre& way);
};

}  // namespace irsim
