// Objects come and go, or change their shape, in the middle of an episode.
#pragma once

#include <vector>

#include "world/state.hpp"

namespace irsim {

/// The present state of an object: one row of a state of one world.
struct Origin {
  const World* world;
  const State* state;
  int object;
};

/// Let `state`, new and of one world, go on where `before` is: its clock, keys, events and whatever else belongs to the
/// world as a whole; each object with the pose, goals, flags, history and shape of its origin. Contacts and stops are
/// those of the last step; sensors look again.
void go_on(const World& world, State& state, const World& world_before, const State& before,
           const std::vector<Origin>& origins);

/// Give an object another body until the next scene is drawn.
void reshape(const World& world, State& state, int row, const std::vector<Outline>& outlines);

}  // namespace irsim
