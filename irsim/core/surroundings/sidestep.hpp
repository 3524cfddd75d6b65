// A small preference for one side, which breaks exact symmetry: without it an object trails one straight ahead for
// ever, two that meet head-on brake to a stand, and a ring locks up.
#pragma once

#include "decision.hpp"

namespace irsim {

/// Turn the wanted velocity of object k of a decision to the right while a moving object is in its lane to the goal.
///
/// The slower the object drives, the further it turns, up to 90 degrees at a stand: in a ring that has locked up, only
/// velocities that point far aside or back are free.
///
/// Args:
///   wanted: Velocity toward the goal, world frame [m/s].
///   angle: Angle to the right; negative to the left, 0 returns `wanted` [degrees].
Vec2 sidestepped(const Decision& decision, int k, Vec2 wanted, double angle);

}  // namespace irsim
