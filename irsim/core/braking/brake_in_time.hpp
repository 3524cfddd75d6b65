// Objects with limited acceleration brake in time.
#pragma once

#include "decision.hpp"

namespace irsim {

/// Whether a control of an object cannot change at once: others need not brake in time.
inline bool has_inertia(const State& state, int row) {
  return std::isfinite(state.acce[row][0]) || std::isfinite(state.acce[row][1]);
}

/// Slow a command down with which object k of a decision could no longer stop before what is near it: before walls, and
/// on its side of a border to each mover. Two objects that do so cannot touch, because each can always stop on its side
/// (Zhou, Wang, Bandyopadhyay, Schwager: Fast, on-line collision avoidance for dynamic vehicles using buffered Voronoi
/// cells, 2017). Objects whose acceleration is not limited keep their commands.
///
/// The border divides the gap between the ways on which both come to rest if they brake now, not between their bodies:
/// so braking is always allowed.
///
/// The behavior is one that `brakes_in_time`.
void brake_in_time(const Decision& decision, int k, Vec3& command);

}  // namespace irsim
