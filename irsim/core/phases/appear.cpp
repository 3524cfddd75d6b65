// Objects that come into the world after its start.
#include <cmath>

#include "phases.hpp"
#include "world/placed_footprints.hpp"
#include "world/spec.hpp"

namespace irsim {

void leave_world(State& state, int row) {
  state.appeared[row] = -1;
  state.pose[row].x = state.pose[row].y = kNone;
}

void appear(const World& world, State& state, int w) {
  const int first = w * world.objects;
  std::vector<int> due;
  for (const int i : world.latecomers) {
    if (!state.absent(first + i) || !state.takes_part[first + i]) continue;
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
    if (!present.fits(i, state.initial_pose[row])) continue;
    present.add(i, state.initial_pose[row]);
    state.pose[row] = state.initial_pose[row];
    state.before[row] = state.pose[row].position();
    state.appeared[row] = state.count[w];
    walls = walls || world.is_static[i];
  }
  if (walls) place_fixed(world, state, w);
}

}  // namespace irsim
