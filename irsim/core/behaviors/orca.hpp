// orca: optimal reciprocal collision avoidance. Each of two objects makes half of the smallest change of velocity that
// keeps them apart for some time. For an object that does not reciprocate the other makes the whole change, and static
// objects are never driven into (van den Berg, Guy, Lin, Manocha: Reciprocal n-body collision avoidance, 2011).
#pragma once

#include <optional>

#include "decision.hpp"
#include "fields.hpp"

namespace irsim {

struct OrcaOptions {
  double neighborDist;             // objects farther away are ignored [m]
  int maxNeighbors;                // largest number of other objects considered, nearest first
  double timeHorizon;              // time horizon for moving objects [s]
  double timeHorizonObst;          // time horizon for walls and static circles [s]
  double safe_radius;              // margin added to the radius of the object [m]
  std::optional<double> maxSpeed;  // [m/s]; none: the limit of the object
  std::optional<double>
      responsibility;                   // share of a change of velocity; none: half for objects that give way, else all
  std::optional<double> approach_time;  // time constant of slowing down at the goal [s]; none: full speed
  double sidestep;  // angle to the right of the wanted velocity while something moving is ahead [degrees]
  static constexpr auto fields() {
    using O = OrcaOptions;
    return std::make_tuple(field("neighborDist", &O::neighborDist), field("maxNeighbors", &O::maxNeighbors),
                           field("timeHorizon", &O::timeHorizon), field("timeHorizonObst", &O::timeHorizonObst),
                           field("safe_radius", &O::safe_radius), field("maxSpeed", &O::maxSpeed),
                           field("responsibility", &O::responsibility), field("approach_time", &O::approach_time),
                           field("sidestep", &O::sidestep));
  }
};

void orca(const OrcaOptions& options, const Decision& decision, Intent* intents);

}  // namespace irsim
