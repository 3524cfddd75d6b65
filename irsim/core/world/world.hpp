// What never changes during an episode. N objects per world, the same template for every copy.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "contact/bodies.hpp"
#include "geometry/vec.hpp"
#include "kinematics.gen.hpp"
#include "sensing/fog.hpp"
#include "world/scene.hpp"

namespace irsim {

struct ObjectSpec;
struct RandomPlacement;
struct BehaviorGroup;
struct Scan;

/// A goal of 2 numbers has theta NaN.
using Goal = Pose;

/// Where a sensor sits in the template, its slice of the beams of a world, and its nominal beams (sensor frame).
struct Mount {
  int object;
  int index;  // among the sensors of the object
  int first, count;
  int first_velocity, velocity_rows;  // its slice of the velocities of a world: rows of `count` numbers
  std::array<double, 3> offset;       // pose in the body frame [m, m, rad]
  std::vector<double> angle, cosine, sine;
};

enum CollisionMode { kStop = 0, kUnobstructed = 1, kUnobstructedObstacles = 2, kContact = 3 };

/// What contacts need to know of an object beside its shape.
struct Matter {
  double mass;         // [kg], may be infinite
  double friction;     // with the ground
  double inertia;      // [kg m^2], NaN: from shape and mass
  double restitution;  // 0 to 1
  double tau;          // lag of the drive [s]
  bool driven;         // has a drive; what has none is pushed only
  bool pushable;       // not static, of finite mass
};

struct World {
  World(double step_time, int collision_mode, double gravity, std::vector<ObjectSpec> specs,
        std::vector<RandomPlacement> placements, int copies, std::optional<Fog> fog);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  double step_time;                // [s]
  int collision_mode;              // CollisionMode
  double gravity;                  // [m/s^2]
  std::array<double, 4> extent{};  // x0, y0, x1, y1 of the world [m]: paths are looked for in there
  int copies;
  int objects;     // N
  int extra_rows;  // E

  // (N,) each
  std::vector<std::uint8_t> is_robot, is_static, unobstructed, wander, loop, state_arrival, target_roles, behaves;
  std::vector<int> group;
  std::vector<int> number;  // what draws and events call the object; equal to its id until others are taken out
  std::vector<Drive> drive;
  std::vector<Matter> matter;
  std::vector<Vec3> vel_min, vel_max, acce;
  std::vector<double> angle_low, angle_high, goal_threshold;
  std::vector<Pose> range_low, range_high;
  std::vector<ObjectSpec> specs;  // as given: initial values, shapes, sensors

  // object ids
  std::vector<int> moving, fixed_objects, robots, visible;  // visible: not unobstructed
  std::vector<int> routed;                                  // with a route to follow
  std::vector<BehaviorGroup> behaviors;
  std::vector<Scan> scans;
  int beams_per_world = 0, velocities_per_world = 0;
  std::optional<Fog> fog;
  std::vector<Mount> fog_beams;  // of each of its views; empty ones without occlusion
  std::vector<RandomPlacement> placements;

  std::shared_ptr<const Shapes> shapes;  // null when some are drawn per scene
  std::shared_ptr<const Bodies> bodies;  // of `shapes`; null until somebody needs them
  std::shared_ptr<const Fixed> fixed;    // at the poses of the template; null when those or shapes are drawn

  /// Cell size of a grid that suits most of these objects.
  double cell(const Shapes& of, const std::vector<int>& ids) const;
};

/// Friction with the ground at most [N]; infinite for what has infinite mass.
inline double ground_friction(const World& world, int object) {
  const Matter& m = world.matter[object];
  return m.friction > 0.0 ? m.friction * m.mass * world.gravity : 0.0;
}

/// The shapes of one scene: drawn where they are random.
std::shared_ptr<const Shapes> make_shapes(const World& world, Key key);
/// The static objects at these poses (those of `world.fixed_objects`).
std::shared_ptr<const Fixed> make_fixed(const World& world, const Shapes& shapes, std::vector<Pose> poses);

}  // namespace irsim
