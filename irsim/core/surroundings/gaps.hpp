// Gaps between footprints at the present poses.
#pragma once

#include <cstdint>
#include <vector>

#include "runs/clearances.hpp"

namespace irsim {

struct State;

/// Write the distance [m] between the footprint of a row and the nearest one of each kind to `out` (kKinds numbers).
/// Distances above `reach` [m] are infinite, distances of overlapping bodies negative.
void gaps(const World& world, const State& state, int row, const std::vector<ObjectKind>& kinds, double reach,
          double* out);

}  // namespace irsim
