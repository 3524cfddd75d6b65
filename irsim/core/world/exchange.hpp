// Objects that are added, removed or reshaped during an episode.
#pragma once

#include <vector>

#include "world/state.hpp"

namespace irsim {

/// Where an object comes from: a row of the state of a single world.
struct Origin {
  const World* world;
  const State* state;
  int object;
};

/// Let `state`, which is new and has one world, continue from `before`. Clock, keys and events come from `before`;
/// each object has the pose, goals, flags, history and shape of its origin. Flags are from the last step; sensors
/// take a new scan.
void continue_from(const World& world, State& state, const World& world_before, const State& before,
                   const std::vector<Origin>& origins);

/// Replace the shape of an object until the next scene is drawn.
void reshape(const World& world, State& state, int row, const std::vector<Outline>& outlines);

}  // namespace irsim
