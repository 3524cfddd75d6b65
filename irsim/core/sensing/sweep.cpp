#include "sensing/sweep.hpp"

#include "integration.hpp"

namespace irsim {
namespace {

struct PastPose {
  Pose pose;
  Vec2 direction;  // cosine and sine of its heading
};

/// Where an object was some time before the end of the step [s], if it moved with its twist of this step all the time.
PastPose past_pose(const Sensing& s, int object, double time) {
  const World& world = s.world;
  const int row = s.w * world.objects + object;
  const Pose& now = s.state.pose[row];
  const Vec3& twist = s.state.twist[row];
  const double yaw_rate = twist[2], half = 0.5 * yaw_rate * time;
  Vec2 way = Vec2{twist[0], twist[1]} * time;
  if (yaw_rate == 0.0) return {{now.x - way.x, now.y - way.y, now.theta}, s.state.heading(row)};
  // The chord of the arc on which it moved then has the direction of the heading in the middle of that time.
  if (world.dynamics[object].driven && world.integration == kExact)
    way = rotate(way, unit(yaw_rate * world.step_time - half)) * sinc(half);
  const double theta = now.theta - yaw_rate * time;
  return {{now.x - way.x, now.y - way.y, theta}, unit(theta)};
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
    const PastPose then = past_pose(s, object, age);
    s.ghosts.place(shapes, object, then.pose, then.direction);
  }
  const PastPose then = past_pose(s, carrier, age);
  const Vec3& twist = s.state.twist[s.w * world.objects + carrier];
  const double elapsed = world.integration == kExact ? world.step_time - age : 0.0;
  const Vec2 arm = rotate({s.mount.offset[0], s.mount.offset[1]}, then.direction);
  const Vec2 velocity = rotate({twist[0], twist[1]}, unit(twist[2] * elapsed)) + Vec2{-arm.y, arm.x} * twist[2];
  Sensing part{world,
               s.state,
               s.w,
               mount,
               then.pose,
               then.direction,
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
