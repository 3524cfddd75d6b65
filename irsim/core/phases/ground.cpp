// The effect of the ground of zones on wheels.
#include "phases.hpp"
#include "sensing/gauges.hpp"
#include "world/features.hpp"

namespace irsim {

void feel_ground(const World& world, State& state, int row) {
  const int w = row / world.objects, object = row % world.objects;
  Underfoot& under = state.underfoot[row];
  std::array<Vec2, 2> places;
  with(world.drive[object], [&](const auto& drive) { places = wheels(drive); });
  const Draws draws(state.key(w), Stream::slip, world.number[object]);
  const Vec2 middle = state.pose[row].position(), heading = state.heading(row);
  for (int k = 0; k < 2; ++k) {
    const Ground* ground = world.zones.ground_at(middle + rotate(places[k], heading));
    if (ground == nullptr) {
      under.wheel[k] = {};
      continue;
    }
    const double scale = state.slip_scale[row];
    double slip = std::min(1.0, ground->slip * scale);
    if (ground->slip_std > 0.0) {
      const double draw = draws.normals(static_cast<std::uint64_t>(state.count[w]))[static_cast<std::size_t>(k)];
      double& wander = under.wander[k];
      const bool lasts = ground->slip_time > 0.0 && std::isfinite(wander);
      wander = lasts ? Wandering{1.0, ground->slip_time}.next(wander, world.step_time, draw) : draw;
      slip = clip(ground->slip * scale + ground->slip_std * scale * wander, 0.0, 1.0);
    }
    under.wheel[k] = {slip, ground->grip * state.grip_scale[row], ground->spread, ground->traction};
  }
}

}  // namespace irsim
