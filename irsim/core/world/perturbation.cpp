// Perturbation of a scene: starts, top speeds and delays are drawn within the spreads of each object, uniformly.
#include <algorithm>

#include "world/placed_footprints.hpp"
#include "world/spec.hpp"
#include "world/state.hpp"

namespace irsim {
namespace {

constexpr std::uint64_t kFirstPose = 1;  // first block of draws for poses; block 0 holds the draws of speed and delay

/// A draw in [0, 1) as a number in [-most, most).
double symmetric(double draw, double most) { return most * (2.0 * draw - 1.0); }

bool is_within(const World& world, const Pose& pose) {
  const auto& e = world.extent;
  return pose.x >= e[0] && pose.x <= e[2] && pose.y >= e[1] && pose.y <= e[3];
}

/// Draws starts of one scene. Objects do not overlap, except objects that overlap in the scene as written.
class Starts {
 public:
  Starts(const World& world, State& state, int w)
      : world_(world),
        state_(state),
        first_(w * world.objects),
        closed_(state.scenes[w].shapes->closed()),
        shapes_(closed_ ? *closed_ : *state.scenes[w].shapes),
        written_(world, shapes_),
        placed_(world, shapes_),
        walls_(world, shapes_) {
    std::vector<std::uint8_t> moved(world.objects, 0);
    for (const Perturbation& each : world.perturbations) moved[each.object] = each.moves();
    for (int i = 0; i < world.objects; ++i) {
      if (!state.takes_part[first_ + i]) continue;
      const Pose& pose = state.initial_pose[first_ + i];
      written_.add(i, pose);
      if (!moved[i]) add(i, pose);
    }
  }

  /// Draw a start until one fits. Returns false if none does.
  bool draw(const Perturbation& spread, const Draws& draws) {
    const int i = spread.object;
    Pose& start = state_.initial_pose[first_ + i];
    const Pose written = start;
    neighbors_ = written_.overlapping(i);
    bool found = false;
    for (int attempt = 0; attempt < std::max(1, spread.attempts) && !found; ++attempt) {
      const auto u = draws.uniforms(kFirstPose + static_cast<std::uint64_t>(attempt));
      start = {written.x + symmetric(u[0], spread.position), written.y + symmetric(u[1], spread.position),
               written.theta};
      if (spread.heading > 0.0) {
        start.theta = into_range(wrap(written.theta + symmetric(u[2], spread.heading)), world_.angle_low[i],
                                 world_.angle_high[i]);
      }
      found = fits(i, written, start);
    }
    add(i, start);
    return found;
  }

 private:
  void add(int object, const Pose& pose) {
    placed_.add(object, pose);
    if (world_.is_static[object]) walls_.add(object, pose);
  }

  bool fits(int object, const Pose& written, const Pose& start) {
    if (is_within(world_, written) && !is_within(world_, start)) return false;
    const auto ignored = [&](int other) { return overlaps_as_written(other); };
    return placed_.fits(object, start, ignored) && (world_.is_static[object] || is_reached(object, written, start));
  }

  /// Whether no static object lies between the start as written and the one drawn, so that nothing starts behind a
  /// wall.
  bool is_reached(int object, const Pose& written, const Pose& start) {
    const Vec2 way = start.position() - written.position();
    const double stride = 0.5 * shapes_.radius[object];
    const int count = stride > 0.0 ? static_cast<int>(std::min(norm(way) / stride, kMaxStrides)) : 0;
    const auto ignored = [&](int other) { return overlaps_as_written(other); };
    for (int k = 1; k <= count; ++k) {
      const double share = static_cast<double>(k) / (count + 1);
      const Pose between{written.x + way.x * share, written.y + way.y * share, start.theta};
      if (!walls_.fits(object, between, ignored)) return false;
    }
    return true;
  }

  bool overlaps_as_written(int other) const {
    return std::find(neighbors_.begin(), neighbors_.end(), other) != neighbors_.end();
  }

  static constexpr double kMaxStrides = 1000.0;

  const World& world_;
  State& state_;
  int first_;
  std::shared_ptr<const Shapes> closed_;  // null if all cells of maps are known
  const Shapes& shapes_;
  PlacedFootprints written_, placed_, walls_;
  std::vector<int> neighbors_;  // objects that overlap the present one in the scene as written
};

}  // namespace

void perturb(const World& world, State& state, int w) {
  const Key key = make_key(state.seed[w], state.scene_index[w], 0);
  for (const Perturbation& spread : world.perturbations) {
    const int row = w * world.objects + spread.object;
    const auto u = Draws(key, Stream::perturbation, world.number[spread.object]).uniforms(0);
    state.pace[row] *= 1.0 + symmetric(u[0], spread.speed);
    state.start_step[row] += static_cast<std::int64_t>(std::ceil(u[1] * spread.delay / world.step_time));
  }
  const auto moves = [](const Perturbation& spread) { return spread.moves(); };
  if (std::none_of(world.perturbations.begin(), world.perturbations.end(), moves)) return;
  Starts starts(world, state, w);
  for (const Perturbation& spread : world.perturbations) {
    if (!spread.moves() || !state.takes_part[w * world.objects + spread.object]) continue;
    if (starts.draw(spread, Draws(key, Stream::perturbation, world.number[spread.object]))) continue;
    state.failed_placement[w] = spread.object;
    return;  // a scene in which an object does not fit is not used
  }
}

}  // namespace irsim
