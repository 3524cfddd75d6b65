// orca: optimal reciprocal collision avoidance. Each of two takes half of the smallest change of velocity that keeps
// them apart for some time; who does not reciprocate is avoided by the whole change, and what stands still is never
// driven into (van den Berg, Guy, Lin, Manocha: Reciprocal n-body collision avoidance, 2011).
#pragma once

#include <optional>

#include "decision.hpp"
#include "fields.hpp"

namespace irsim {

struct OrcaOptions {
  double neighborDist;             // others farther away are ignored [m]
  int maxNeighbors;                // most others considered, nearest first
  double timeHorizon;              // how far ahead others are avoided [s]
  double timeHorizonObst;          // how far ahead walls and standing circles are avoided [s]
  double safe_radius;              // added to the own radius [m]
  std::optional<double> maxSpeed;  // none: the object's own [m/s]
  static constexpr auto fields() {
    using O = OrcaOptions;
    return std::make_tuple(field("neighborDist", &O::neighborDist), field("maxNeighbors", &O::maxNeighbors),
                           field("timeHorizon", &O::timeHorizon), field("timeHorizonObst", &O::timeHorizonObst),
                           field("safe_radius", &O::safe_radius), field("maxSpeed", &O::maxSpeed));
  }
};

void orca(const OrcaOptions& options, const Decision& decision, Intent* intents);

}  // namespace irsim
