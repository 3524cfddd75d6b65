#include "orca/crowd.hpp"

#include "footprints/crowd.hpp"

#include <optional>

#include "world/features.hpp"
#include "world/spec.hpp"
#include "world/state.hpp"
#include "world/world.hpp"

namespace irsim {
namespace {

/// Margin that a behavior adds to the radius of its objects [m]; none for one that is not built on ORCA.
std::optional<double> margin_of(const Behavior& behavior, double radius) {
  constexpr double kDefaultShare = 0.1;  // of the radius: `avocado` inflates bodies by a tenth
  if (const auto* orca = std::get_if<OrcaOptions>(&behavior)) return orca->safe_radius;
  if (const auto* avocado = std::get_if<AvocadoOptions>(&behavior))
    return avocado->safe_radius ? *avocado->safe_radius : kDefaultShare * radius;
  if (const auto* footprints = std::get_if<FootprintOrcaOptions>(&behavior)) return footprints->safe_distance;
  return std::nullopt;
}

}  // namespace

OrcaCrowd& crowd(const World& world, const State& state, Workspace& work, int w) {
  OrcaCrowd& all = work.orca;
  if (all.known) return all;
  all.known = true;
  if (all.outlines) all.outlines->known = false;
  const Neighbors& near = neighbors(world, state, work, w);
  const Shapes& shapes = *state.scenes[w].shapes;
  const std::size_t count = world.moving.size();
  all.movers.resize(count);
  all.speed2.resize(count);
  all.group.assign(count, -1);
  all.member_of.assign(count, -1);
  if (all.neighbors_before.size() != count) all.neighbors_before.assign(count, {});
  all.nearest.clear();
  double off2 = 0.0;
  for (std::size_t m = 0; m < count; ++m) {
    const int i = world.moving[m], row = w * world.objects + i;
    const Vec2 centre = state.pose[row].position() + rotate(shapes.centre[i], state.heading(row));
    all.movers[m] = {centre, near.discs[m].velocity, shapes.radius[i]};
    all.nearest.add(centre);
    all.speed2[m] = squared(near.discs[m].velocity);
    off2 = std::max(off2, squared(shapes.centre[i]));
  }
  all.off_origin = std::sqrt(off2);
  all.nearest.build();
  for (std::size_t g = 0; g < world.behaviors.size(); ++g) {
    const BehaviorGroup& behavior = world.behaviors[g];
    if (!margin_of(behavior.behavior, 0.0)) continue;
    for (const int i : behavior.objects) {
      if (world.is_static[i]) continue;
      const int m = shapes.placed[i].object, row = w * world.objects + i;
      all.member_of[m] = static_cast<int>(g);
      all.movers[m].radius += *margin_of(behavior.behavior, all.movers[m].radius);
      if (!state.stopped[row] && !state.given[row] && !state.waits(row)) all.group[m] = static_cast<int>(g);
    }
  }
  return all;
}

}  // namespace irsim
