// orca: optimal reciprocal collision avoidance. Each of two objects makes half of the smallest change of velocity that
// keeps them apart for some time. For an object that does not reciprocate the other makes the whole change, and static
// objects are never driven into (van den Berg, Guy, Lin, Manocha: Reciprocal n-body collision avoidance, 2011).
#pragma once

#include "decision.hpp"
#include "orca/settings.hpp"

namespace irsim {

struct OrcaOptions : OrcaSettings {
  double safe_radius;  // margin added to the radius of the object [m]

  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return shared_fields(visit, field("safe_radius", &OrcaOptions::safe_radius),
                         field("responsibility", &OrcaSettings::responsibility));
  }
};

void orca(const OrcaOptions& options, const Decision& decision, Intent* intents);

}  // namespace irsim
