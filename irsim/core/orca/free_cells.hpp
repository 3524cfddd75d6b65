// Space that belongs to one body for the next step: bodies that stay in their own space cannot touch.
#pragma once

#include <vector>

#include "orca/hull_planes.hpp"

namespace irsim {

/// A line that a body must not cross in the next step.
struct Border {
  Vec2 axis;     // unit vector into the space of the body
  double limit;  // smallest dot product of `axis` with its hull, without rounding [m]
};

/// The border between a body and a neighbor.
///
/// Two bodies divide the gap between them along the axis that both find, in proportion to their speeds toward each
/// other, which both know: each may use its part however it moves, as in buffered Voronoi cells (Zhou, Wang, Bandyopadhyay,
/// Schwager: Fast, on-line collision avoidance for dynamic vehicles using buffered Voronoi cells, 2017).
///
/// Args:
///   own, other: Speeds toward each other along the axis, at least 0 [m/s].
///   margin: Part of the gap that nobody uses [m].
Border border(const Hull& body, const Separation& apart, double own, double other, double margin);

/// The border of a body that leaves the whole gap but `margin` to itself.
Border border(const Hull& body, const Separation& apart, double margin);

/// Hull of a body at another pose.
///
/// Args:
///   place: Position at which `body` is [m].
///   shift: Change of the position [m].
///   turn: Cosine and sine of the change of heading.
/// Returns: The smallest amount by which it stays within all borders [m]; negative if it crosses one.
double room(const Hull& body, Vec2 place, Vec2 shift, Vec2 turn, const std::vector<Border>& borders);

}  // namespace irsim
