// Random placement. Footprints must not overlap those placed before: fixed objects first, then entries in file order.
#include "world/placed_footprints.hpp"
#include "world/spec.hpp"
#include "world/state.hpp"

namespace irsim {
namespace {

constexpr std::uint64_t kGoalDraws = std::uint64_t{1}
                                     << 40;  // first block of draws for goals; draws for states start at 0

/// Points of one entry that keep a minimum distance from each other.
class Spread {
 public:
  explicit Spread(double distance) : distance_(distance), grid_(distance) {}
  bool fits(Vec2 p) const {
    if (!(distance_ > 0.0)) return true;
    return !grid_.any(box_around(p, distance_), [&](int k) { return !(norm(points_[k] - p) >= distance_); });
  }
  void add(Vec2 p) {
    grid_.add(static_cast<int>(points_.size()), box_around(p, 0.0));
    points_.push_back(p);
  }

 private:
  double distance_;
  GrowingGrid grid_;
  std::vector<Vec2> points_;
};

/// Draw poses until one fits. Returns false if none does; `pose` is then the last draw.
bool draw_pose(const RandomPlacement& entry, int attempts, const Draws& draws, std::uint64_t first, int object,
               const Spread& spread, PlacedFootprints& placed, Pose& pose) {
  const auto &low = entry.range_low, &high = entry.range_high;
  for (int attempt = 0; attempt < std::max(1, attempts); ++attempt) {
    const auto u = draws.uniforms(first + static_cast<std::uint64_t>(attempt));
    pose = {low[0] + (high[0] - low[0]) * u[0], low[1] + (high[1] - low[1]) * u[1], low[2] + (high[2] - low[2]) * u[2]};
    if (spread.fits(pose.position()) && placed.fits(object, pose)) return true;
  }
  return false;
}

}  // namespace

void place_randomly(const World& world, State& state, int w) {
  const int first = w * world.objects;
  const Key key = make_key(state.seed[w], state.scene_index[w], 0);
  const Shapes& shapes = *state.scenes[w].shapes;
  const auto failed = [&](int object) {
    if (state.failed_placement[w] < 0) state.failed_placement[w] = object;
  };
  // A scene in which an object does not fit is not used, so the objects after it are drawn only once.
  const auto attempts = [&](const RandomPlacement& entry) {
    return state.failed_placement[w] < 0 ? entry.attempts : 1;
  };

  std::vector<std::uint8_t> random(world.objects, 0);
  for (const RandomPlacement& entry : world.placements) {
    for (const int i : entry.objects) random[i] = 1;
  }
  PlacedFootprints states(world, shapes);
  for (int i = 0; i < world.objects; ++i) {
    if (!random[i]) states.add(i, state.initial_pose[first + i]);
  }
  for (const RandomPlacement& entry : world.placements) {
    Spread spread(entry.min_distance);
    for (const int i : entry.objects) {
      Pose& pose = state.initial_pose[first + i];
      if (!draw_pose(entry, attempts(entry), Draws(key, Stream::placement, world.number[i]), 0, i, spread, states,
                     pose))
        failed(i);
      spread.add(pose.position());
      states.add(i, pose);
    }
  }

  PlacedFootprints still(world, shapes);
  for (const int i : world.fixed_objects) still.add(i, state.initial_pose[first + i]);
  for (const RandomPlacement& entry : world.placements) {
    Spread spread(entry.min_distance);
    PlacedFootprints goals = still;  // objects of different entries may have the same goal
    for (const int i : entry.objects) {
      if (world.wander[i]) continue;  // their goals are drawn at every reset
      Goal goal;
      if (world.is_static[i] ||
          !world.dynamics[i].driven) {  // these objects never reach a goal, but IR-SIM gives them one
        const auto u = Draws(key, Stream::placement, world.number[i]).uniforms(kGoalDraws);
        const auto &low = entry.range_low, &high = entry.range_high;
        state.goals[first + i].initial = {{low[0] + (high[0] - low[0]) * u[0], low[1] + (high[1] - low[1]) * u[1],
                                           low[2] + (high[2] - low[2]) * u[2]}};
        continue;
      }
      if (!draw_pose(entry, attempts(entry), Draws(key, Stream::placement, world.number[i]), kGoalDraws, i, spread,
                     goals, goal))
        failed(i);
      spread.add(goal.position());
      goals.add(i, goal);
      state.goals[first + i].initial = {goal};
    }
  }
}

}  // namespace irsim
