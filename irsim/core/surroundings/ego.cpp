#include "surroundings/ego.hpp"

namespace irsim {
namespace {

constexpr double kAtGoal = 0.1;  // objects nearer to their goal than this want to stand still [m]

/// Top speeds along the x and y axes of the wanted velocity.
template <class Drive>
Vec2 top_speeds(const Drive&, Vec3 top) {
  return {top[0], top[0]};
}
Vec2 top_speeds(const OmniOptions&, Vec3 top) { return {top[0], top[1]}; }
Vec2 top_speeds(const OmniAngularOptions&, Vec3 top) { return {top[0], top[1]}; }

}  // namespace

Ego ego_of(const Decision& decision, int k) {
  const World& world = decision.world;
  const int i = decision.objects[k], row = decision.row(k);
  const Neighbors& near = neighbors(world, decision.state, decision.work, decision.w());
  const Scene& scene = decision.state.scenes[decision.w()];
  const Disc& disc = near.discs[scene.shapes->placed[i].object];
  const Vec2 position = decision.state.pose[row].position();
  Ego ego{i,
          row,
          position,
          disc.velocity,
          {},
          disc.radius + kPadding,
          decision.state.route_of(row),
          decision.state.pace[row]};
  const Vec2 way = decision.state.destination(row).position() - position;
  const double distance = norm(way);
  if (!(distance > kAtGoal)) return ego;
  const Vec3& limits = decision.state.vel_max[row];
  const Vec2 top = std::visit([&](const auto& drive) { return top_speeds(drive, limits); }, world.drive[i]);
  ego.desired = {top.x * way.x / distance, top.y * way.y / distance};
  return ego;
}

}  // namespace irsim
