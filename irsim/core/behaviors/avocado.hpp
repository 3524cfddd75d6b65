// avocado: ORCA whose share of the avoidance follows from how much each other object gives way, which an object learns
// from what it sees (Martinez-Baselga, Sebastian, Montijano, Riazuelo, Sagues, Montano: AVOCADO: adaptive optimal
// collision avoidance driven by opinion, IEEE Transactions on Robotics, 2025). It is written from equations, not from
// the authors' program. The damping d multiplies the opinion and what pulls it, so that opinions stay within -1 and 1.
#pragma once

#include <optional>

#include "decision.hpp"
#include "fields.hpp"

namespace irsim {

struct AvocadoOptions {
  double neighborDist;                  // objects farther away are ignored [m]
  int maxNeighbors;                     // largest number of other objects considered, nearest first
  double timeHorizon;                   // time horizon for moving objects [s]
  double timeHorizonObst;               // time horizon for walls and static circles [s]
  std::optional<double> safe_radius;    // margin added to the radius of the object [m]; none: a tenth of the radius
  std::optional<double> maxSpeed;       // [m/s]; none: the limit of the object
  std::optional<double> approach_time;  // time constant of slowing down at the goal [s]; none: full speed
  double sidestep;         // angle to the right of the wanted velocity while something moving is ahead [degrees]
  double forgetting;       // d: rate at which an opinion returns to neutral [1/s]
  double own_weight;       // a: weight of the opinion itself
  double evidence_weight;  // c: weight of what was observed
  double evidence_gain;    // epsilon: steepness of what counts as giving way
  double bias;             // b: constant change of an opinion [1/s]
  double attention_time;   // kappa: time to a collision that gets most of the attention [s]
  double attention_step;   // delta: share of the attention that is renewed in a step
  double noise;            // eta: largest error of an observed velocity, without attention [m/s]

  static constexpr auto fields() {
    using O = AvocadoOptions;
    return std::make_tuple(field("neighborDist", &O::neighborDist), field("maxNeighbors", &O::maxNeighbors),
                           field("timeHorizon", &O::timeHorizon), field("timeHorizonObst", &O::timeHorizonObst),
                           field("safe_radius", &O::safe_radius), field("maxSpeed", &O::maxSpeed),
                           field("approach_time", &O::approach_time), field("sidestep", &O::sidestep),
                           field("forgetting", &O::forgetting), field("own_weight", &O::own_weight),
                           field("evidence_weight", &O::evidence_weight), field("evidence_gain", &O::evidence_gain),
                           field("bias", &O::bias), field("attention_time", &O::attention_time),
                           field("attention_step", &O::attention_step), field("noise", &O::noise));
  }
};

void avocado(const AvocadoOptions& options, const Decision& decision, Intent* intents);

}  // namespace irsim
