// The motion of one object in a step.
#pragma once

#include "geometry/vec.hpp"

namespace irsim {

/// The motion of an object from a pose at time 0 to another one at time 1. Its heading turns at a constant rate. The
/// origin of its body moves on a chord at constant velocity, or on the arc that a constant twist gives.
struct Stride {
  Pose from;
  Vec2 by;            // displacement of the origin [m]
  double turn = 0.0;  // [rad]
  bool arc = false;

  /// The motion between two poses in which the object turned by about `turn` [rad]; headings are known up to full
  /// turns.
  static Stride between(const Pose& from, const Pose& to, double turn, bool arc) {
    double turned = to.theta - from.theta;
    if (std::fabs(turn - turned) > kPi) turned += kTurn * std::round((turn - turned) / kTurn);
    // A full circle ends where it began: nothing tells its radius.
    return {from, to.position() - from.position(), turned, arc && turned != 0.0 && std::fabs(turned) < 6.0};
  }
  static Stride resting(const Pose& at) { return {at, {}, 0.0, false}; }

  bool rests() const { return by.x == 0.0 && by.y == 0.0 && turn == 0.0; }
  Pose at(double time) const {
    Vec2 moved = by * time;
    if (arc)
      moved = rotate(by, unit(-0.5 * turn * (1.0 - time))) * (std::sin(0.5 * turn * time) / std::sin(0.5 * turn));
    return {from.x + moved.x, from.y + moved.y, from.theta + turn * time};
  }
  /// Velocity of the origin [m per step].
  Vec2 velocity(double time) const {
    return arc ? rotate(by, unit(turn * (time - 0.5))) * (0.5 * turn / std::sin(0.5 * turn)) : by;
  }
  /// Upper bound of the acceleration of a point at a distance from the origin [m per step^2].
  double acceleration(double distance) const {
    const double own = turn * turn * distance;
    return arc ? own + std::fabs(turn) * norm(velocity(0.0)) : own;
  }
  /// How far a point at a distance from the origin may leave the straight line between its places at both ends [m].
  double bulge(double distance) const { return 0.125 * acceleration(distance); }
};

}  // namespace irsim
