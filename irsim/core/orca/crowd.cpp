#include "orca/crowd.hpp"

#include "world/features.hpp"
#include "world/spec.hpp"
#include "world/state.hpp"
#include "world/world.hpp"

namespace irsim {

OrcaCrowd& crowd(const World& world, const State& state, Workspace& work, int w) {
  OrcaCrowd& all = work.orca;
  if (all.known) return all;
  all.known = true;
  const Neighbors& near = neighbors(world, state, work, w);
  const Shapes& shapes = *state.scenes[w].shapes;
  const std::size_t count = world.moving.size();
  all.movers.resize(count);
  all.group.assign(count, -1);
  all.member_of.assign(count, -1);
  if (all.neighbors_before.size() != count) all.neighbors_before.assign(count, {});
  all.nearest.clear();
  for (std::size_t m = 0; m < count; ++m) {
    const int i = world.moving[m], row = w * world.objects + i;
    const Vec2 centre = state.pose[row].position() + rotate(shapes.centre[i], state.heading(row));
    all.movers[m] = {centre, near.discs[m].velocity, shapes.radius[i]};
    all.nearest.add(centre);
  }
  all.nearest.build();
  for (std::size_t g = 0; g < world.behaviors.size(); ++g) {
    const BehaviorGroup& behavior = world.behaviors[g];
    const auto* options = std::get_if<OrcaOptions>(&behavior.behavior);
    if (options == nullptr) continue;
    for (const int i : behavior.objects) {
      if (world.is_static[i]) continue;
      const int m = shapes.placed[i].object, row = w * world.objects + i;
      all.member_of[m] = static_cast<int>(g);
      all.movers[m].radius += options->safe_radius;
      if (!state.stopped[row] && !state.given[row] && !state.waits(row)) all.group[m] = static_cast<int>(g);
    }
  }
  return all;
}

}  // namespace irsim
