// footprint_orca: orca on the convex hulls of footprints instead of circles, for crowds of robots.
#pragma once

#include <optional>

#include "decision.hpp"

namespace irsim {

struct FootprintOrcaOptions {
  double neighborDist;             // objects farther away are ignored [m]
  int maxNeighbors;                // largest number of other moving objects considered, nearest first
  double timeHorizon;              // time horizon for moving objects [s]
  double timeHorizonObst;          // time horizon for what stands [s]
  double safe_distance;            // distance kept from other objects [m]
  std::optional<double> maxSpeed;  // [m/s]; none: the limit of the object
  bool backward;                   // whether drives that can do so also drive backward

  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using O = FootprintOrcaOptions;
    return visit(field("neighborDist", &O::neighborDist), field("maxNeighbors", &O::maxNeighbors),
                 field("timeHorizon", &O::timeHorizon), field("timeHorizonObst", &O::timeHorizonObst),
                 field("safe_distance", &O::safe_distance), field("maxSpeed", &O::maxSpeed),
                 field("backward", &O::backward));
  }
};

void footprint_orca(const FootprintOrcaOptions& options, const Decision& decision, Intent* intents);

}  // namespace irsim
