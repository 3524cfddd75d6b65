// Fields of view: who is seen.
#pragma once

#include <vector>

#include "world/state.hpp"
#include "world/workspace.hpp"
#include "world/world.hpp"

namespace irsim {

/// Where an object looks: `angle` is the whole opening [rad], `reach` in metres from its origin along its heading.
struct View {
  double angle, reach;
  bool occlusion;  // parts hidden behind what is not unobstructed do not count
};

/// Ids, ascending, of the objects of world w of which some part lies in the view of `object`, at the present poses.
std::vector<int> in_view(const World& world, State& state, int w, int object, const View& view, Workspace& work);

}  // namespace irsim
