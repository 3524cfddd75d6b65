// Sonar: the distance to the nearest surface in a cone that returns sound.
#pragma once

#include "sensing/cone.hpp"

namespace irsim {

struct SonarOptions : ConeOptions {
  double crosstalk;  // share of readings in which another sonar is heard
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return ConeOptions::fields(
        [&](const auto&... cone) { return visit(cone..., field("crosstalk", &SonarOptions::crosstalk)); });
  }
};

inline int readings(const SonarOptions&) { return kConeReadings; }

inline void sonar(const SonarOptions& o, const Sensing& s) {
  const auto luck = s.draws(1).uniforms(s.scan_number());
  double range = measured(o, s, nearest_echo(o, s, false), luck[0]);
  // Foreign sound comes at any time; the first sound that arrives counts.
  if (luck[1] < o.crosstalk) range = std::min(range, o.range_min + luck[2] * (o.range_max - o.range_min));
  report(o, s, range);
}

}  // namespace irsim
