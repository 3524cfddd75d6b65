// Options that all behaviors built on ORCA have.
#pragma once

#include <optional>

#include "fields.hpp"

namespace irsim {

struct OrcaSettings {
  double neighborDist;                  // objects farther away are ignored [m]
  int maxNeighbors;                     // largest number of other objects considered, nearest first
  double timeHorizon;                   // time horizon for moving objects [s]
  double timeHorizonObst;               // time horizon for walls and static circles [s]
  std::optional<double> maxSpeed;       // [m/s]; none: the limit of the object
  std::optional<double> approach_time;  // time constant of slowing down at the goal [s]; none: full speed
  // angle to the right of the wanted velocity while something moving is ahead [degrees]; none: only ties are broken
  std::optional<double> sidestep;
  // share of a change of velocity, without a `Reciprocity`; none: half for objects that give way, else all
  std::optional<double> responsibility;

  /// The fields of every such behavior, then `more`; `responsibility` is one of `orca` alone.
  template <class Visit, class... More>
  static constexpr auto shared_fields(const Visit& visit, const More&... more) {
    using O = OrcaSettings;
    return visit(field("neighborDist", &O::neighborDist), field("maxNeighbors", &O::maxNeighbors),
                 field("timeHorizon", &O::timeHorizon), field("timeHorizonObst", &O::timeHorizonObst),
                 field("maxSpeed", &O::maxSpeed), field("approach_time", &O::approach_time),
                 field("sidestep", &O::sidestep), more...);
  }
};

}  // namespace irsim
