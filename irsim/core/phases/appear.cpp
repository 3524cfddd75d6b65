// Objects that come into the world after its start, or leave it before the end.
#include <cmath>
#include <optional>
#include <variant>

#include "phases.hpp"
#include "world/placed_footprints.hpp"
#include "world/spec.hpp"

namespace irsim {
namespace {

/// The place of a recording at this step; null for an object that replays none.
std::optional<Pose> recorded_place(const World& world, const State& state, int w, int object) {
  const auto* recording = std::get_if<ReplayOptions>(&world.specs[object].behavior);
  if (!recording || recording->times.empty()) return std::nullopt;
  const double time = static_cast<double>(state.count[w]) * world.step_time;
  return replayed(*recording, time, state.initial_pose[w * world.objects + object].theta);
}

}  // namespace

void leave_world(State& state, int row) {
  state.appeared[row] = -1;
  state.pose[row].x = state.pose[row].y = kNone;
}

void vanish(const World& world, State& state, int w) {
  for (const int i : world.leavers) {
    const int row = w * world.objects + i;
    if (state.absent(row) || state.count[w] < world.specs[i].vanish_step) continue;
    const std::int64_t since = state.appeared[row];
    leave_world(state, row);
    state.appeared[row] = -2 - since;
    state.control[row] = state.twist[row] = {};
  }
}

void appear(const World& world, State& state, int w) {
  const int first = w * world.objects;
  std::vector<int> due;
  for (const int i : world.latecomers) {
    if (state.appeared[first + i] != -1 || !state.takes_part[first + i]) continue;
    if (!std::isnan(state.pose[first + i].x)) {  // the caller has put it somewhere
      state.appeared[first + i] = state.count[w];
    } else if (state.count[w] >= world.specs[i].appear_step) {
      due.push_back(i);
    }
  }
  if (due.empty()) return;
  PlacedFootprints present(world, *state.scenes[w].shapes);
  for (int i = 0; i < world.objects; ++i) {
    if (!state.absent(first + i)) present.add(i, state.pose[first + i]);
  }
  bool walls = false;
  for (const int i : due) {
    const int row = first + i;
    const std::optional<Pose> recorded = recorded_place(world, state, w, i);
    const Pose place = recorded ? *recorded : state.initial_pose[row];
    if (!recorded && !present.fits(i, place)) continue;
    present.add(i, place);
    state.pose[row] = place;
    state.before[row] = state.pose[row];
    state.appeared[row] = state.count[w];
    walls = walls || world.is_static[i];
  }
  if (walls) place_fixed(world, state, w);
}

}  // namespace irsim
