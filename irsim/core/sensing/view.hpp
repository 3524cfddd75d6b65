// Fields of view: which objects are seen.
#pragma once

#include <vector>

#include "world/state.hpp"
#include "world/workspace.hpp"
#include "world/world.hpp"

namespace irsim {

/// A field of view about the heading of an object: `angle` is the full opening angle [rad], `reach` the range from its
/// origin [m].
struct View {
  double angle, reach;
  bool occlusion;  // whether parts hidden behind objects that are not unobstructed are left out
};

/// Ids, ascending, of the objects of world w that are partly or wholly in the view of `object` at the present poses.
std::vector<int> in_view(const World& world, State& state, int w, int object, const View& view, Workspace& work);

}  // namespace irsim
