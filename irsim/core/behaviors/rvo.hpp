// rvo: reciprocal velocity obstacles, by sampling. van den Berg, Lin, Manocha: "Reciprocal
// velocity obstacles for real-time multi-agent navigation" (2008); Snape, van den Berg, Guy, Manocha: "The hybrid
// reciprocal velocity obstacle" (2011).
#pragma once

#include <optional>

#include "decision.hpp"
#include "fields.hpp"

namespace irsim {

enum class Avoidance { rvo, hrvo, vo };
/// How a drive that cannot move sideways turns while it avoids something: at once, as fast as its own limit allows, or
/// at fixed rates, as in IR-SIM.
enum class RvoTurning { limit, fixed };

struct RvoOptions {
  double vxmax, vymax;  // bounds of the search, world axes [m/s]
  double acce;          // half width of the search window [m/s]
  double factor;        // weight of the time to collision if every velocity is blocked
  Avoidance mode;
  double neighbor_threshold;  // reach within which objects are avoided [m]
  // angle to the right of the wanted velocity while something moving is ahead [degrees]; none: only ties are broken
  std::optional<double> sidestep;
  RvoTurning turning;
  std::optional<bool> keep_gap;  // whether a step takes only a share of a gap; unset: for robots

  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using R = RvoOptions;
    return visit(field("vxmax", &R::vxmax), field("vymax", &R::vymax), field("acce", &R::acce),
                 field("factor", &R::factor), choice("mode", &R::mode, "rvo", "hrvo", "vo"),
                 field("neighbor_threshold", &R::neighbor_threshold), field("sidestep", &R::sidestep),
                 choice("turning", &R::turning, "limit", "fixed"), field("keep_gap", &R::keep_gap));
  }
};

void rvo(const RvoOptions& options, const Decision& decision, Intent* intents);

}  // namespace irsim
