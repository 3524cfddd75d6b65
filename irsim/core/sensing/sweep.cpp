#include "sensing/sweep.hpp"

#include "integration.hpp"

namespace irsim {
namespace {

/// Where an object was some time before the end of the step [s], if it moved with its twist of this step all the time.
Pose pose_before(const Sensing& s, int object, double time) {
  const World& world = s.world;
  const int row = s.w * world.objects + object;
  const Pose& now = s.state.pose[row];
  const Vec3& twist = s.state.twist[row];
  const Integration integration = world.dynamics[object].driven ? world.integration : kEuler;
  const Vec2 way = displacement({twist[0], twist[1]}, twist[2], world.step_time, integration);
  const Pose start{now.x - way.x, now.y - way.y, now.theta - twist[2] * world.step_time};
  return pose_at(start, twist, world.step_time - time, integration);
}

}  // namespace

Sensing part_of_sweep(const LidarErrors& errors, const Sensing& s, int k) {
  const World& world = s.world;
  const Mount& mount = s.parts[k];
  const int first = mount.first - s.mount.first, carrier = mount.object;
  const double age = errors.beam_time * (s.mount.count - 1 - first - 0.5 * (mount.count - 1));
  const Shapes& shapes = *s.state.scenes[s.w].shapes;
  s.ghosts.resize(shapes.size[0]);
  for (const int object : world.moving) {
    if (world.unobstructed[object] || object == carrier) continue;
    const Pose pose = pose_before(s, object, age);
    s.ghosts.place(shapes, object, pose, unit(pose.theta));
  }
  const Pose pose = pose_before(s, carrier, age);
  const Vec3& twist = s.state.twist[s.w * world.objects + carrier];
  const double elapsed = world.integration == kExact ? world.step_time - age : 0.0;
  const Vec2 arm = rotate({s.mount.offset[0], s.mount.offset[1]}, unit(pose.theta));
  const Vec2 velocity = rotate({twist[0], twist[1]}, unit(twist[2] * elapsed)) + Vec2{-arm.y, arm.x} * twist[2];
  Sensing part{world,
               s.state,
               s.w,
               mount,
               pose,
               unit(pose.theta),
               s.ranges + first,
               s.hits + first,
               s.valid + first,
               s.velocities + first,
               s.readings,
               s.memory,
               s.object_velocities,
               s.buffers,
               s.spare,
               s.parts,
               s.ghosts};
  part.first_beam = first, part.all_beams = s.mount.count;
  part.spin = twist[2] * errors.beam_time, part.drift = velocity * errors.beam_time;
  part.beam_time = errors.beam_time, part.earlier = true;
  return part;
}

}  // namespace irsim
