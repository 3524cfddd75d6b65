// The motion of a body until it stands: the poses of a step and of the stop after it, or of a stop that begins at once.
#pragma once

#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

struct State;
struct World;

/// Where a body is, relative to where it is now.
struct Place {
  Vec2 shift;     // change of its position [m]
  double angle;   // change of its heading [rad]
  Vec2 turn;      // cosine and sine of it
  double time;    // in steps from now
  double travel;  // no point of the body moves farther since the place before [m]
};

/// Places of a body in their order, the present one first. Between two of them each of its points stays within `bulge`
/// of the straight line between where it is at both.
struct Manoeuvre {
  std::vector<Place> places;
  bool arcs = false;    // whether it is on an arc between two places, with a heading that turns linearly
  double bulge = 0.0;   // [m]
  double travel = 0.0;  // sum over the places [m]

  void clear() { places.assign(1, {{}, 0.0, {1.0, 0.0}, 0.0, 0.0}), bulge = travel = 0.0; }
  bool moves() const { return places.size() > 1; }
};

/// An object whose drive is run ahead, from its present pose and control.
struct Ahead {
  const World& world;
  const State& state;
  int row, object;
  double reach;                // distance of its outermost point from its position [m]
  std::vector<double>& extra;  // scratch memory: extra rows of its state, those before the step

  /// The control that its limits leave of a wanted one.
  Vec3 limited(Vec3 wanted) const;
  /// The control that brakes as hard as possible: a standstill; the wheels of a car keep their angle.
  Vec3 braking() const;
  /// Write the places of the step with this control, which its limits allow, and of the stop after it.
  void step_and_stop(Vec3 control, Manoeuvre& out) const;
  /// Write the places of a stop that begins at once.
  void stop(Manoeuvre& out) const;
  /// Largest distance that a point of it can move in a step and the stop after it [m].
  double range() const;
  /// Largest distance from the places of a stop that begins at once to the places of any step and the stop after it
  /// [m].
  double play() const;
};

/// Whether an object cannot stop, or stop turning, at once.
bool glides(const World& world, const State& state, int row, int object);

}  // namespace irsim
