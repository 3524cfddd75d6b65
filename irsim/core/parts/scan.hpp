// The shortest range of each group of neighboring beams of the first lidar.
#pragma once

#include <optional>

#include "fields.hpp"
#include "observing.hpp"

namespace irsim {

struct ScanOptions {
  int sectors;
  std::optional<double> range_max;  // range that becomes 1 [m]; none: the largest range of the lidar
  bool nearness;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using O = ScanOptions;
    return visit(field("sectors", &O::sectors), field("range_max", &O::range_max), field("nearness", &O::nearness));
  }
};

inline std::size_t members(const ScanOptions&) { return 0; }
inline std::size_t width(const ScanOptions& o) { return o.sectors; }

/// The lidar has at least as many beams as there are sectors.
inline void scan(const ScanOptions& o, const Seen& seen, double* out, std::uint8_t*) {
  const double far = o.range_max.value_or(seen.range_max);
  const std::size_t sectors = o.sectors;
  for (std::size_t s = 0; s < sectors; ++s) {
    const std::size_t first = s * seen.beams / sectors, last = (s + 1) * seen.beams / sectors;
    double nearest = seen.ranges[first];
    for (std::size_t b = first + 1; b < last; ++b) nearest = std::min(nearest, seen.ranges[b]);
    const double part = clip(nearest / far, 0.0, 1.0);
    out[s] = o.nearness ? 1.0 - part : part;
  }
}

}  // namespace irsim
