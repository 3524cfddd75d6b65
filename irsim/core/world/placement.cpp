// Random placement. Footprints must not overlap those placed before: fixed objects first, then entries in file order.
#include <algorithm>

#include "planning/body.hpp"
#include "world/crossing.hpp"
#include "world/placed_footprints.hpp"
#include "world/spec.hpp"
#include "world/state.hpp"

namespace irsim {
namespace {

constexpr std::uint64_t kGoalDraws = std::uint64_t{1}
                                     << 40;  // first block of draws for goals; draws for states start at 0

/// Whether an object has a goal that it could reach; objects that wander get theirs at every reset.
bool travels(const World& world, int object) {
  return !world.is_static[object] && world.dynamics[object].driven && !world.wander[object];
}

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

/// The facts about a scene while its objects are placed.
struct Known {
  const World& world;
  const State& state;
  const Shapes& shapes;
  int first;                                // row of the first object
  std::vector<std::uint8_t> starts, goals;  // (N,) whether the start, or the goals, of an object are known
};

/// Areas that the footprints of one entry keep clear of.
class KeptClear {
 public:
  KeptClear(const RandomPlacement& entry, const Known& known) {
    for (const std::vector<double>& point : entry.keep_points)
      areas_.push_back({Body::disc(point[2]), Vec2{point[0], point[1]}, kAll});
    for (std::size_t k = 0; k < entry.keep_objects.size(); ++k)
      add_places(known, entry.keep_objects[k], entry.keep_radii[k], kAll);
    // Objects of another entry that keep clear of one of this entry: the distance holds both ways.
    for (const Placement& placement : known.world.placements) {
      const auto* other = std::get_if<RandomPlacement>(&placement);
      if (other == nullptr || other == &entry) continue;
      for (std::size_t k = 0; k < other->keep_objects.size(); ++k) {
        const int mine = other->keep_objects[k];
        if (std::find(entry.objects.begin(), entry.objects.end(), mine) == entry.objects.end()) continue;
        for (const int object : other->objects) add_places(known, object, other->keep_radii[k], mine);
      }
    }
  }
  /// Whether the object may be at a pose. `places` is where its footprint is put.
  bool allow(int object, const Pose& pose, PlacedFootprints& places) {
    return std::none_of(areas_.begin(), areas_.end(), [&](Area& area) {
      return (area.object == kAll || area.object == object) && places.meets(object, pose, area.body.at(area.place));
    });
  }

 private:
  static constexpr int kAll = -1;
  struct Area {
    Body body;
    Vec2 place;
    int object;  // object of the entry that keeps clear of it, or all
  };

  /// Add the start of an object, and the goals that it could reach, as far as they are known.
  void add_places(const Known& known, int object, double radius, int kept_by) {
    if (!known.starts[object]) return;
    const Pose& start = known.state.initial_pose[known.first + object];
    add(known.shapes, object, start, radius, kept_by);
    if (!known.goals[object] || !travels(known.world, object)) return;
    for (const Goal& goal : known.state.goals[known.first + object].initial) {
      add(known.shapes, object, {goal.x, goal.y, std::isnan(goal.theta) ? start.theta : goal.theta}, radius, kept_by);
    }
  }
  void add(const Shapes& shapes, int object, const Pose& pose, double radius, int kept_by) {
    areas_.push_back({Body::of(shapes, object, pose.theta, radius), pose.position(), kept_by});
  }

  std::vector<Area> areas_;
};

/// From which starts of one entry goals can be found that are far enough.
class FarGoals {
 public:
  explicit FarGoals(const RandomPlacement& entry) : entry_(entry) {
    if (!(entry.goal_distance > 0.0)) return;
    int most = 0;  // from a corner of the starts
    for (const double x : {entry.range_low[0], entry.range_high[0]}) {
      for (const double y : {entry.range_low[1], entry.range_high[1]}) most = std::max(most, places({x, y}));
    }
    enough_ = std::clamp(most / 4, 1, kEnough);
  }
  bool exist(Vec2 start) const { return !(entry_.goal_distance > 0.0) || places(start) >= enough_; }
  bool fits(Vec2 start, Vec2 goal) const {
    return !(entry_.goal_distance > 0.0) || norm(goal - start) >= entry_.goal_distance;
  }

 private:
  /// Number of places of a grid over the range of goals, up to its corners, that are far enough.
  int places(Vec2 start) const {
    const auto &low = entry_.goal_low, &high = entry_.goal_high;
    int count = 0;
    for (int i = 0; i <= kGrid; ++i) {
      for (int j = 0; j <= kGrid; ++j) {
        const Vec2 p{low[0] + (high[0] - low[0]) * i / kGrid, low[1] + (high[1] - low[1]) * j / kGrid};
        count += norm(p - start) >= entry_.goal_distance;
      }
    }
    return count;
  }

  static constexpr int kGrid = 20;
  static constexpr int kEnough = 9;  // two percent of the places: a thousand draws nearly always find one
  const RandomPlacement& entry_;
  int enough_ = 0;
};

/// A pose between two bounds.
Pose draw_between(const std::array<double, 3>& low, const std::array<double, 3>& high, const Draws& draws,
                  std::uint64_t number) {
  const auto u = draws.uniforms(number);
  return {low[0] + (high[0] - low[0]) * u[0], low[1] + (high[1] - low[1]) * u[1], low[2] + (high[2] - low[2]) * u[2]};
}

/// Draw poses until `fits()` holds for one. Returns false if none does; `pose` is then the last draw.
template <class Fits>
bool draw_pose(const std::array<double, 3>& low, const std::array<double, 3>& high, int attempts, const Draws& draws,
               std::uint64_t first, const Spread& spread, Pose& pose, Fits&& fits) {
  for (int attempt = 0; attempt < attempts; ++attempt) {
    pose = draw_between(low, high, draws, first + static_cast<std::uint64_t>(attempt));
    if (spread.fits(pose.position()) && fits()) return true;
  }
  return false;
}

}  // namespace

void place_randomly(const World& world, State& state, int w) {
  const int first = w * world.objects;
  const Key key = make_key(state.seed[w], state.scene_index[w], 0);
  const auto closed = state.scenes[w].shapes->closed();
  const Shapes& shapes = closed ? *closed : *state.scenes[w].shapes;
  const auto failed = [&](int object) {
    if (state.failed_placement[w] < 0) state.failed_placement[w] = object;
  };
  // A scene in which an object does not fit is not used, so the objects after it are drawn only once.
  const auto attempts = [&](const auto& entry) {
    return state.failed_placement[w] < 0 ? std::max(1, entry.attempts) : 1;
  };
  const auto draws = [&](int object) { return Draws(key, Stream::placement, world.number[object]); };

  std::vector<std::uint8_t> random(world.objects, 0);
  bool crossings = false;
  for (const Placement& placement : world.placements) {
    for (const int i : placed_objects(placement)) random[i] = 1;
    crossings = crossings || !std::holds_alternative<RandomPlacement>(placement);
  }
  CrossingPlaces placed{PlacedFootprints(world, shapes), std::nullopt, std::nullopt};
  if (crossings) placed.ends.emplace(world, shapes), placed.goals.emplace(world, shapes);
  const auto add_start = [&](int object) {
    const Pose& start = state.initial_pose[first + object];
    placed.starts.add(object, start);
    if (placed.ends && world.is_static[object]) placed.ends->add(object, start);
  };
  for (int i = 0; i < world.objects; ++i) {
    if (random[i] || !state.takes_part[first + i]) continue;
    add_start(i);
    const std::vector<Goal>& goals = state.goals[first + i].initial;
    if (!placed.ends || !travels(world, i) || goals.empty()) continue;
    Pose last = goals.back();
    if (std::isnan(last.theta)) last.theta = state.initial_pose[first + i].theta;
    placed.ends->add(i, last);
  }
  const auto takes_part = [&](int object) { return state.takes_part[first + object] != 0; };
  Known known{world, state, shapes, first, {}, {}};
  for (int i = 0; i < world.objects; ++i) known.starts.push_back(!random[i] && takes_part(i));
  known.goals = known.starts;
  PlacedFootprints anywhere(world, shapes);  // in which footprints are compared with areas to keep clear of
  const auto place_starts = [&](const RandomPlacement& entry) {
    Spread spread(entry.min_distance);
    KeptClear kept(entry, known);
    const FarGoals far(entry);
    for (const int i : entry.objects) {
      if (!takes_part(i)) continue;
      Pose& pose = state.initial_pose[first + i];
      // what stands still must not stand on goals that are known already
      const auto fits = [&] {
        return kept.allow(i, pose, anywhere) && (!travels(world, i) || far.exist(pose.position())) &&
               placed.starts.fits(i, pose) && (!placed.goals || !world.is_static[i] || placed.goals->fits(i, pose));
      };
      if (!draw_pose(entry.range_low, entry.range_high, attempts(entry), draws(i), 0, spread, pose, fits)) failed(i);
      spread.add(pose.position());
      add_start(i);
    }
  };
  const auto place_crossing = [&](const auto& entry) {
    for (const int i : entry.objects) {
      if (!takes_part(i)) continue;
      const bool goes = travels(world, i);
      const Crossing drawn = draw_crossing(entry, draws(i), attempts(entry), i, goes, placed);
      if (!drawn.fits) failed(i);
      state.initial_pose[first + i] = drawn.start;
      add_start(i);
      if (world.wander[i]) continue;
      state.goals[first + i].initial = {drawn.goal};
      if (!goes) continue;
      placed.ends->add(i, drawn.goal);
      placed.goals->add(i, drawn.goal);
    }
  };
  for (const Placement& placement : world.placements) {
    std::visit(
        [&](const auto& entry) {
          if constexpr (std::is_same_v<std::decay_t<decltype(entry)>, RandomPlacement>)
            place_starts(entry);
          else
            place_crossing(entry);
        },
        placement);
    const bool crossing = !std::holds_alternative<RandomPlacement>(placement);
    for (const int i : placed_objects(placement)) {
      known.starts[i] = takes_part(i);
      known.goals[i] = crossing && takes_part(i);
    }
  }

  // Goals keep clear of what stands still, and of the goals that are known before them.
  PlacedFootprints goals(world, shapes);
  for (const int i : world.fixed_objects) {
    if (takes_part(i)) goals.add(i, state.initial_pose[first + i]);
  }
  for (int i = 0; i < world.objects; ++i) {
    const std::vector<Goal>& own = state.goals[first + i].initial;
    if (!known.goals[i] || !travels(world, i) || own.empty()) continue;
    Pose last = own.back();
    if (std::isnan(last.theta)) last.theta = state.initial_pose[first + i].theta;
    goals.add(i, last);
  }
  for (const Placement& placement : world.placements) {
    const auto* entry = std::get_if<RandomPlacement>(&placement);
    if (entry == nullptr) continue;
    Spread spread(entry->min_distance);
    KeptClear kept(*entry, known);
    const FarGoals far(*entry);
    for (const int i : entry->objects) {
      if (world.wander[i] || !takes_part(i)) continue;  // their goals are drawn at every reset
      Goal goal;
      if (!travels(world, i)) {  // these objects never reach a goal, but IR-SIM gives them one
        state.goals[first + i].initial = {draw_between(entry->goal_low, entry->goal_high, draws(i), kGoalDraws)};
        continue;
      }
      const Vec2 start = state.initial_pose[first + i].position();
      const auto fits = [&] {
        return far.fits(start, goal.position()) && kept.allow(i, goal, anywhere) && goals.fits(i, goal);
      };
      const bool found =
          draw_pose(entry->goal_low, entry->goal_high, attempts(*entry), draws(i), kGoalDraws, spread, goal, fits);
      if (!found) failed(i);
      spread.add(goal.position());
      goals.add(i, goal);
      state.goals[first + i].initial = {goal};
    }
    for (const int i : entry->objects) known.goals[i] = takes_part(i);
  }
}

}  // namespace irsim
