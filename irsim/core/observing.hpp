// The input of an observation part: what one robot knows of itself, its goal and its surroundings, and the frames in
// which parts express it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "geometry/vec.hpp"
#include "networks/functions.hpp"

namespace irsim {

/// Another object as a robot sees it, world frame.
struct Neighbor {
  Vec2 position;    // of the middle of its bounding circle [m]
  double heading;   // [rad]
  Vec2 ahead;       // cosine and sine of the heading
  Vec2 velocity;    // [m/s]
  double radius;    // of its bounding circle [m]
  double arrived;   // 1 for a robot that has reached its last goal
  double is_robot;  // 1 for a robot
  bool present = true;
  // how far both footprints reach toward each other along the line between the centres [m]
  double extent = 0.0, own_extent = 0.0;
};

/// Static objects as a grid of nx * ny cells; cell (i, j) is at i * ny + j.
struct Picture {
  const std::uint8_t* occupied;
  std::size_t nx, ny;
  Vec2 origin;        // corner of cell (0, 0) [m]
  double resolution;  // side of a cell [m]
};

struct Seen {
  Pose pose;
  Vec2 ahead;  // cosine and sine of the heading
  double steering;
  Vec2 velocity;
  Vec2 commanded;  // world-frame velocity that the robot was last asked to follow; zero before [m/s]
  double yaw_rate;
  Vec3 control, low, high;
  Pose goal;
  double goal_threshold, radius, arrived;
  // nearest first; null where nothing is observed
  const Neighbor* neighbors = nullptr;
  std::size_t neighbor_count = 0;
  const double* ranges = nullptr;
  std::size_t beams = 0;
  double range_max = 0.0;
  const Picture* picture = nullptr;

  bool has_goal() const { return std::isfinite(goal.x) && std::isfinite(goal.y); }
  /// Vector from the robot to its goal [m], world frame; zero without a goal.
  Vec2 to_goal() const { return has_goal() ? goal.position() - pose.position() : Vec2{}; }
};

/// own: x points ahead; goal: x points to the goal (ahead without one); world: as in the scenario.
enum class Frame { own, goal, world };

/// Cosine and sine of the direction of the x axis of a frame.
inline Vec2 x_axis(Frame frame, const Seen& seen) {
  if (frame == Frame::world) return {1.0, 0.0};
  if (frame == Frame::own) return seen.ahead;
  const Vec2 offset = seen.to_goal();
  const double distance = norm(offset);
  return distance > 0.0 ? Vec2{offset.x / distance, offset.y / distance} : seen.ahead;
}

/// `value` in units of `limit`, with `clipped` within -1 and 1.
inline double share(double value, double limit, bool clipped) {
  const double scaled = value / limit;
  return clipped ? clip(scaled, -1.0, 1.0) : scaled;
}

/// A direction in a frame with this x axis, rounding errors beyond 1 cut off.
inline Vec2 facing(Vec2 direction, Vec2 axis) {
  const Vec2 turned = unrotate(direction, axis);
  return {clip(turned.x, -1.0, 1.0), clip(turned.y, -1.0, 1.0)};
}

}  // namespace irsim
