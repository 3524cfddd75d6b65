// Infrared range sensor: the distance to the nearest surface in a narrow cone that returns light.
#pragma once

#include "sensing/cone.hpp"

namespace irsim {

struct IrRangeOptions : ConeOptions {
  bool folds;  // whether surfaces nearer than range_min read farther than they are
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return ConeOptions::fields(
        [&](const auto&... cone) { return visit(cone..., field("folds", &IrRangeOptions::folds)); });
  }
};

inline int readings(const IrRangeOptions&) { return kConeReadings; }

inline void ir_range(const IrRangeOptions& o, const Sensing& s) {
  double exact = nearest_echo(o, s, true);
  // A sensor that triangulates has a voltage that falls as 1 / range beyond range_min and, below it, rises with the
  // range: range_min^2 / range has the same voltage.
  if (o.folds && exact < o.range_min) exact = o.range_min * o.range_min / std::max(exact, 1e-9);
  report(o, s, measured(o, s, exact, s.draws(1).uniforms(s.scan_number())[0]));
}

}  // namespace irsim
