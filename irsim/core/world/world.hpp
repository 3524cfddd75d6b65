// The data that never changes during an episode: N objects per world, with the same template for every copy.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "contact/bodies.hpp"
#include "drives.hpp"
#include "geometry/vec.hpp"
#include "sensing/fog.hpp"
#include "surroundings/perception.hpp"
#include "world/actuation.hpp"
#include "world/scene.hpp"
#include "world/variation.hpp"
#include "world/zones.hpp"

namespace irsim {

struct ObjectSpec;
struct RandomPlacement;
struct CircleCrossing;
struct SquareCrossing;
struct Perturbation;
struct BehaviorGroup;
struct Scan;

/// The objects of one entry whose places are drawn for each scene.
using Placement = std::variant<RandomPlacement, CircleCrossing, SquareCrossing>;

/// A goal without a heading has theta NaN.
using Goal = Pose;

/// Where a sensor is mounted, its slice of the beams of a world, and its nominal beams in the sensor frame.
struct Mount {
  int object;
  int index;  // index among the sensors of the object
  int first, count;
  int first_velocity, velocity_rows;  // slice of the velocities of a world: rows of `count` numbers
  int first_reading, readings;        // slice of the readings of a world, of sensors that report them instead
  int first_memory, memory;           // slice of what the sensors of a world remember
  std::array<double, 3> offset;       // pose in the body frame [m, m, rad]
  std::vector<double> angle, cosine, sine;

  /// Number of beams with data of their own; a sensor with readings only tells what follows from its rays.
  int reported() const { return readings > 0 ? 0 : count; }
};

enum CollisionMode { kStop = 0, kUnobstructed = 1, kUnobstructedObstacles = 2, kContact = 3 };
/// The conduct of a robot at its last goal: it counts as arrived only while it is there, it stands still, it arrives
/// for good.
enum AfterArrival { kUnlatched = 0, kFreeze = 1, kYield = 2 };

/// The facts about an object that contacts need besides its shape.
struct BodyDynamics {
  double mass;         // [kg], may be infinite
  double friction;     // coefficient of friction with the ground
  double inertia;      // [kg m^2], NaN: from shape and mass
  double restitution;  // bounciness, 0 to 1
  double tau;          // time constant of the drive [s]
  bool driven;         // whether it has a drive; a body without one moves only when it is pushed
  bool pushable;       // whether it is not static, has a finite mass, and is not an obstacle that replays a recording
};

/// A surface throws the light of a lidar in all directions, lets it pass unless it comes from ahead, or throws it in
/// one direction.
enum class Material : std::uint8_t { matt, glass, mirror };

/// Which contacts are collisions: those at the ends of steps, or those within steps, too.
enum Contacts { kStepEnd = 0, kSwept = 1 };

struct World {
  World(double step_time, int collision_mode, double gravity, std::vector<ObjectSpec> specs,
        std::vector<Placement> placements, int copies, std::optional<Fog> fog, std::vector<Perturbation> perturbations,
        Zones zones, std::vector<View> views, const std::vector<int>& targets);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  double step_time;       // [s]
  int collision_mode;     // CollisionMode
  int after_arrival = 0;  // AfterArrival
  Integration integration = kEuler;
  int contacts = kStepEnd;         // Contacts
  double gravity;                  // [m/s^2]
  std::array<double, 4> extent{};  // x0, y0, x1, y1 [m]: paths are planned within this box
  int copies;
  int objects;     // N
  int extra_rows;  // E

  // (N,) for each object
  std::vector<std::uint8_t> is_robot, is_static, unobstructed, wander, loop, state_arrival, target_roles, behaves;
  std::vector<std::uint8_t> unstoppable;  // whether nothing stops or pushes it: an obstacle that replays a recording
  std::vector<int> group;
  std::vector<int> number;  // id in draws and events; equal to the index until objects are removed
  std::vector<Drive> drive;
  std::vector<BodyDynamics> dynamics;
  std::vector<std::uint8_t> has_actuators;
  std::vector<Actuators> actuators;  // empty if no object has any
  std::vector<Vec3> vel_min, vel_max, acce;
  std::vector<double> angle_low, angle_high;
  // Distance from the goal at which an object rests. One that goes by an estimate is judged by twice as much: what its
  // specification says.
  std::vector<double> goal_threshold;
  std::vector<Pose> range_low, range_high;
  std::vector<double> reflectivity;
  std::vector<Material> material;
  bool optics = false;                     // whether a material is not matt
  std::vector<std::array<bool, 3>> paced;  // whether a control is a speed that perturbation or variation changes
  std::vector<ObjectSpec> specs;           // as given: initial values, shapes, sensors

  // object ids
  std::vector<int> moving, fixed_objects, robots, visible;  // `visible`: objects that are not unobstructed
  std::vector<int> routed;                                  // objects with a route to follow
  std::vector<int> latecomers;                              // objects that appear after the start
  std::vector<int> leavers;                                 // objects that leave the world before the end
  std::vector<BehaviorGroup> behaviors;
  std::vector<Scan> scans;             // sensors with beams
  std::vector<Scan> gauges;            // sensors that report numbers instead
  bool detects = false;                // whether one of them is a detector
  std::vector<Perception> perception;  // (N,) what objects go by; empty if all of them know the truth
  int beams_per_world = 0, velocities_per_world = 0, readings_per_world = 0, memory_per_world = 0;
  std::size_t sensors_per_world = 0;  // first `scans`, then `gauges`
  std::size_t pending_times = 0, pending_beams = 0, pending_velocities = 0, pending_readings = 0;  // of each world
  std::size_t queue_slots = 0;  // commands that wait for their dead time, of all objects of a world
  std::optional<Fog> fog;
  std::vector<Mount> fog_beams;  // beams of each view of the fog; empty for views without occlusion
  std::vector<Placement> placements;
  std::vector<Perturbation> perturbations;       // of different objects, static ones first
  std::vector<Level> levels;                     // what varies between scenes; empty if nothing does
  std::vector<std::shared_ptr<World>> variants;  // the same objects at other places, with other shapes and goals
  Zones zones;                                   // what objects enter or cross, and other ground
  bool wheels_slip;                              // whether some wheels turn otherwise than the body moves
  std::vector<View> views;                       // fields of view that are watched
  std::vector<std::uint8_t> is_target;           // (N,) whether it is watched who sees an object

  std::shared_ptr<const Shapes> shapes;  // null if some are drawn for each scene
  std::shared_ptr<const Bodies> bodies;  // rigid bodies of `shapes`; null until they are needed
  std::shared_ptr<const Fixed> fixed;    // at the poses of the template; null if these poses or shapes are drawn

  /// Let scenes vary. `speeds`: controls of each object that are speeds.
  void set_levels(std::vector<Level> levels, const std::vector<std::vector<int>>& speeds);
  /// Set the variants that levels choose from.
  void set_variants(std::vector<std::shared_ptr<World>> variants);

  /// Cell size of a grid that suits most of these objects [m].
  double cell(const Shapes& of, const std::vector<int>& ids) const;
};

/// Whether an object has one of some roles. 0: all, 1: robots, 2: obstacles.
inline bool has_role(const World& world, int roles, int object) {
  return roles == 0 || (roles == 1) == (world.is_robot[object] != 0);
}

/// Largest friction with the ground [N]; infinite for an object of infinite mass.
inline double ground_friction(const World& world, int object) {
  const BodyDynamics& m = world.dynamics[object];
  return m.friction > 0.0 ? m.friction * m.mass * world.gravity : 0.0;
}

/// The shapes of one scene; random ones are drawn.
std::shared_ptr<const Shapes> make_shapes(const World& world, Key key);
/// The geometry of the static objects (`world.fixed_objects`) at these poses.
std::shared_ptr<const Fixed> make_fixed(const World& world, const Shapes& shapes, std::vector<Pose> poses);

}  // namespace irsim
