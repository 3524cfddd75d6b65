// avocado: ORCA whose share of the avoidance follows from how much each other object gives way, which an object learns
// from what it sees (Martinez-Baselga, Sebastian, Montijano, Riazuelo, Sagues, Montano: AVOCADO: adaptive optimal
// collision avoidance driven by opinion, IEEE Transactions on Robotics, 2025). It is written from equations, not from
// the authors' program. The damping d multiplies the opinion and what pulls it, so that opinions stay within -1 and 1.
#pragma once

#include <optional>

#include "decision.hpp"
#include "orca/settings.hpp"

namespace irsim {

/// The reading of an object of which nothing was needed in the last step, as at first sight: nothing, or that it did
/// not give way.
enum class NoNeed { neutral, authors };

struct AvocadoOptions : OrcaSettings {
  std::optional<double> safe_radius;  // margin added to the radius of the object [m]; none: a tenth of the radius
  double forgetting;                  // d: rate at which an opinion returns to neutral [1/s]
  double own_weight;                  // a: weight of the opinion itself
  double evidence_weight;             // c: weight of what was observed
  double evidence_gain;               // epsilon: steepness of what counts as giving way
  NoNeed evidence;                    // where nothing was needed
  bool memory;                        // whether opinions of objects out of reach are kept
  double bias;                        // b: constant change of an opinion [1/s]
  double attention_time;              // kappa: time to a collision that gets most of the attention [s]
  double attention_step;              // delta: share of the attention that is renewed in a step
  double noise;                       // eta: largest error of an observed velocity, without attention [m/s]
  std::optional<bool> keep_gap;       // whether a step takes only a share of a gap; unset: for robots after a tie

  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using O = AvocadoOptions;
    return shared_fields(
        visit, field("safe_radius", &O::safe_radius), field("forgetting", &O::forgetting),
        field("own_weight", &O::own_weight), field("evidence_weight", &O::evidence_weight),
        field("evidence_gain", &O::evidence_gain), choice("evidence", &O::evidence, "neutral", "authors"),
        field("memory", &O::memory), field("bias", &O::bias), field("attention_time", &O::attention_time),
        field("attention_step", &O::attention_step), field("noise", &O::noise), field("keep_gap", &O::keep_gap));
  }
};

void avocado(const AvocadoOptions& options, const Decision& decision, Intent* intents);

}  // namespace irsim
