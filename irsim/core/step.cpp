// One period of one world. This page is the simulator; the rest is how.
#include "phases.hpp"

namespace irsim {

void step(const World& world, State& state, int w, Workspace& work, bool external) {
  if (!external) {
    decide(world, state, w, work);  // goals renewed; behaviors -> wanted controls, all from one snapshot
    limit(world, state, w);         // speed and acceleration limits -> executed controls
    integrate(world, state, w);     // kinematics, noise -> poses
    if (world.collision_mode == kContact) push_apart(world, state, w, work);
  }
  finish(world, state, w);       // the step counts, the history grows
  collide(world, state, w);      // broad phase, exact narrow phase, what the mode does about it
  arrive(world, state, w);       // goals, waypoints
  sense(world, state, w, work);  // lidars
}

bool done(const World& world, const State& state, int w) {
  const int first = w * world.objects;
  for (const int i : world.robots) {
    if (!state.arrived[first + i] && !state.stopped[first + i]) return false;
  }
  return !world.robots.empty();
}

}  // namespace irsim
