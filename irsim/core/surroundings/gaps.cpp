#include "surroundings/gaps.hpp"

#include <algorithm>

#include "collision/distance.hpp"
#include "world/state.hpp"

namespace irsim {

void gaps(const World& world, const State& state, int row, const std::vector<ObjectKind>& kinds, double reach,
          double* out) {
  const int w = row / world.objects, self = row % world.objects;
  std::fill(out, out + kKinds, kInfinity);
  const Footprint own = state.footprint(world, w, self);
  const auto look = [&](int other) {
    if (other == self || kinds[other] == ObjectKind::ignored) return;
    double& nearest = out[static_cast<int>(kinds[other])];
    const auto [centre, radius] = state.bounds(world, w, other);
    // Bounding circles that are farther apart need no look at the outlines; overlaps can be deeper than circles show.
    if (norm(centre - own.centre) - radius - own.radius > std::min(reach, std::max(nearest, 0.0))) return;
    const double gap = distance(own, state.footprint(world, w, other));
    if (gap <= reach) nearest = std::min(nearest, gap);
  };
  for (const int other : world.moving) look(other);
  const Fixed& fixed = *state.scenes[w].fixed;
  if (own.box.finite() && std::isfinite(reach)) {
    fixed.grid.query({own.box.x0 - reach, own.box.y0 - reach, own.box.x1 + reach, own.box.y1 + reach}, look);
  } else {
    for (const int other : world.fixed_objects) look(other);
  }
}

}  // namespace irsim
