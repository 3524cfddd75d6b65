#include "orca/standing.hpp"

#include <algorithm>

#include "orca/obstacles.hpp"
#include "world/features.hpp"
#include "world/scene.hpp"

namespace irsim {
namespace {

constexpr double kStill = 1e-7;         // slower objects stand [m/s]
constexpr double kAtDestination = 0.1;  // objects nearer to their goal than this want nothing else [m]

/// Whether a mover stands and wants nothing else: it has arrived, has no behavior, or is stopped.
bool stays(const World& world, const State& state, int row, int object, double speed2) {
  if (speed2 > kStill * kStill || state.waits(row)) return false;
  if (state.stopped[row] || !(norm(state.destination(row).position() - state.pose[row].position()) > kAtDestination))
    return true;
  return std::none_of(world.behaviors.begin(), world.behaviors.end(), [&](const BehaviorGroup& group) {
    return std::find(group.objects.begin(), group.objects.end(), object) != group.objects.end();
  });
}

}  // namespace

bool stands_ahead(const OrcaSettings& options, const World& world, const State& state, int w, int self, Vec2 ahead,
                  double speed, double far, const OrcaCrowd& all) {
  const OrcaAgent& agent = all.movers[self];
  const auto is_ahead = [&](Vec2 centre, double radius) {
    const Vec2 offset = centre - agent.position;
    const double along = dot(ahead, offset);
    return along > 0.0 && std::fabs(cross(ahead, offset)) <= kParallelSine * along &&
           along - radius - agent.radius < far;
  };
  const int object = world.moving[self], first = w * world.objects;
  for (const int m : all.neighbors_before[self]) {
    const OrcaAgent& other = all.movers[m];
    if (is_ahead(other.position, other.radius) &&
        stays(world, state, first + world.moving[m], world.moving[m], all.speed2[m]))
      return true;
  }
  if (state.route_of(first + object) != nullptr) return false;  // a route already leads past static objects
  const Obstacles& obstacles = state.scenes[w].fixed->obstacles;
  const int edges = static_cast<int>(obstacles.edges.size());
  bool found = false;
  obstacles.near(box_around(agent.position, options.timeHorizonObst * speed + agent.radius), [&](int k) {
    if (found || k < edges) return;
    const StaticDisc& disc = obstacles.discs[k - edges];
    found = targets_role(world, object, disc.object) && is_ahead(disc.centre, disc.radius);
  });
  return found;
}

}  // namespace irsim
