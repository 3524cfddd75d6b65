// One period of one world. This page is the simulator; all other files say how.
#include "phases.hpp"
#include "surroundings/perception.hpp"

namespace irsim {

void step(const World& world, State& state, int w, Workspace& work, bool external) {
  if (!external) {
    decide(world, state, w, work);  // renew goals; behaviors -> wanted controls, all from the same snapshot
    limit(world, state, w);         // speed and acceleration limits -> executed controls
    integrate(world, state, w);     // kinematics, noise -> poses
    if (world.collision_mode == kContact) push_apart(world, state, w, work);
  }
  finish(world, state, w);       // count the step; some appear or vanish; extend the history
  collide(world, state, w);      // broad phase, exact narrow phase, effects of the collision mode
  arrive(world, state, w);       // goals, waypoints
  sense(world, state, w, work);  // lidars, fog
  watch(world, state, w, work);  // zones and fields of view -> events
}

bool done(const World& world, const State& state, int w) {
  const int first = w * world.objects;
  for (const int i : world.robots) {
    if (!state.takes_part[first + i]) continue;
    const auto& arrived = estimates(world, i) ? state.believes_arrived : state.arrived;
    if (!arrived[first + i] && !state.stopped[first + i]) return false;
  }
  return !world.robots.empty();
}

}  // namespace irsim
