// Ties: two objects whose motion is each other's mirror image about the line midway between them. Whatever one of them
// does to pass, the other does as well, so that neither passes. Both then prefer their own right, which is decided by
// their bodies alone: neither ids nor the order of the file matter, and where nothing is mirrored nothing changes.
// `rvo` chooses among samples, so that two of its objects that have just broken their tie may be mirrored again but for
// the spacing of its grid. For a while they count as mirrored if they almost are.
#pragma once

#include <optional>

#include "surroundings/ego.hpp"

namespace irsim {

constexpr double kTieTurn = 10.0;   // turn of a wanted velocity that breaks a tie [degrees]
constexpr double kTieSpeed = 0.11;  // velocities of a mirrored pair differ by less: two steps of the grid of rvo [m/s]
constexpr double kTieDirection = 1e-7;  // largest difference of mirrored directions to the goals
constexpr double kTieHorizon = 10.0;    // ways that meet later do not matter yet [s]
constexpr double kLaneMargin = 0.1;     // margin on either side of the lane of two objects [m]

/// Two objects, the second one seen from the first, world frame.
struct MirrorPair {
  int row, other;               // rows of the state
  Vec2 velocity, its_velocity;  // [m/s]
  double speed;                 // at which the first one wants to move [m/s]
  double lane;                  // distance of the origins below which the objects are in each other's way [m]
  double tolerance;             // for the velocities [m/s]
  double direction;             // for the directions to the goals
};

/// Whether two velocities may belong to a mirrored pair: their sum has no part along the line through both. This is
/// the cheap half of the test, without a root.
///
/// Args:
///   offset: From one object to the other, not longer than `reach` [m].
///   sum: Of both velocities [m/s].
///   tolerance: For the part along the line, at this reach [m/s].
inline bool may_mirror(Vec2 offset, Vec2 sum, double reach, double tolerance) {
  return std::fabs(dot(sum, offset)) <= tolerance * reach;
}

/// How far an object comes on its way to the goal until ways that meet matter no more. It is made once for an object,
/// and asked for each of its neighbors before anything else: that takes two products.
struct TieWay {
  Vec2 ahead;               // twice that, along the way [m]
  double from = kInfinity;  // product of `ahead` and where the object is, less what it may be wrong by [m^2]

  /// Of an object that breaks no ties: nothing meets.
  TieWay() = default;
  /// Args:
  ///   here: Where the object is [m].
  ///   way: To the goal, `far` [m] away.
  ///   speed: At which the object wants to move [m/s].
  ///   off: How far `here` and where others are may be from the origins, together [m].
  ///   reach: Others are nearer than this [m].
  TieWay(Vec2 here, Vec2 way, double far, double speed, double off, double reach) {
    const double length = 2.0 * kTieHorizon * speed;
    ahead = way * (length / far);
    const double wrong = off + kRounding * (std::fabs(here.x) + std::fabs(here.y) + reach);
    from = dot(ahead, here) - wrong * (length + 2.0 * reach);
  }
  /// Whether the ways of a mirrored pair may meet soon: the cheapest part of the test. Values that are not numbers may.
  ///
  /// Args:
  ///   there: Where the other one is [m].
  ///   gap2: Square of the distance [m^2].
  bool may_meet(Vec2 there, double gap2) const { return !(dot(ahead, there) - from < gap2); }

 private:
  static constexpr double kRounding = 1e-12;  // error of a position, as a share of it, so that rounding does not decide
};

/// The sine of the angle from the way of the first object of a mirrored pair to the other one, positive on the left;
/// nothing if the objects are not mirror images or their ways do not meet.
///
/// Velocities and directions to the goals must mirror each other. Two that stand without a goal, two that drive side by
/// side, and one that follows another are not such a pair.
std::optional<double> mirrored(const State& state, const MirrorPair& pair);

/// The rest of `tied`, for a pair that passes `may_mirror`.
bool is_tied(const Decision& decision, const Ego& ego, const Disc& other, double tolerance, double direction);

/// Whether the ego and another object, within `reach` [m], are a mirrored pair.
///
/// Args:
///   tolerance: For the velocities [m/s].
///   direction: For the directions to the goals.
inline bool tied(const Decision& decision, const Ego& ego, const Disc& other, double reach, double tolerance,
                 double direction = kTieDirection) {
  const Vec2 offset = decision.state.pose[decision.first_row + other.object].position() - ego.position;
  if (!may_mirror(offset, ego.velocity + other.velocity, reach, tolerance)) return false;
  return is_tied(decision, ego, other, tolerance, direction);
}

/// A wanted velocity turned to the right by an angle [degrees].
inline Vec2 keep_right(Vec2 wanted, double angle) { return rotate(wanted, unit(-angle * (kPi / 180.0))); }

}  // namespace irsim
