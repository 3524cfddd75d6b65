// The nearest other objects, a set of `count` members.
#pragma once

#include <optional>
#include <vector>

#include "fields.hpp"
#include "observing.hpp"

namespace irsim {

struct NeighborsOptions {
  enum Feature {
    kX,
    kY,
    kVx,
    kVy,
    kHeadingCos,
    kHeadingSin,
    kRadius,
    kRadii,
    kDistance,
    kGap,
    kExtent,
    kOwnExtent,
    kExtentGap,
    kNearness,
    kGoalDistance,
    kArrived,
    kRobot,
    kPresent
  };
  std::vector<Feature> features;
  int count;
  std::optional<double> range;  // largest gap [m]
  bool nearest_last;
  Frame frame;
  bool relative_velocity;
  double distance_max;  // [m]
  double speed_max;     // [m/s]
  double radius_max;    // [m]
  double decay;         // [m]
  bool clip;
  static constexpr auto fields() {
    using O = NeighborsOptions;
    return std::make_tuple(choices("features", &O::features, "x", "y", "vx", "vy", "heading_cos", "heading_sin",
                                   "radius", "radii", "distance", "gap", "extent", "own_extent", "extent_gap",
                                   "nearness", "goal_distance", "arrived", "robot", "present"),
                           field("count", &O::count), field("range", &O::range),
                           field("nearest_last", &O::nearest_last), choice("frame", &O::frame, "own", "goal", "world"),
                           field("relative_velocity", &O::relative_velocity), field("distance_max", &O::distance_max),
                           field("speed_max", &O::speed_max), field("radius_max", &O::radius_max),
                           field("decay", &O::decay), field("clip", &O::clip));
  }
};

inline std::size_t members(const NeighborsOptions& o) { return o.count; }
inline std::size_t width(const NeighborsOptions& o) { return o.features.size(); }

inline void neighbor(const NeighborsOptions& o, const Seen& seen, const Neighbor& other, Vec2 axis, double gap,
                     double* out) {
  const Vec2 away = other.position - seen.pose.position();
  const Vec2 position = unrotate(away, axis);
  const Vec2 velocity = unrotate(o.relative_velocity ? other.velocity - seen.velocity : other.velocity, axis);
  for (const auto feature : o.features) {
    switch (feature) {
      case NeighborsOptions::kX:
        *out++ = share(position.x, o.distance_max, o.clip);
        break;
      case NeighborsOptions::kY:
        *out++ = share(position.y, o.distance_max, o.clip);
        break;
      case NeighborsOptions::kVx:
        *out++ = share(velocity.x, o.speed_max, o.clip);
        break;
      case NeighborsOptions::kVy:
        *out++ = share(velocity.y, o.speed_max, o.clip);
        break;
      case NeighborsOptions::kHeadingCos:
        *out++ = facing(other.ahead, axis).x;
        break;
      case NeighborsOptions::kHeadingSin:
        *out++ = facing(other.ahead, axis).y;
        break;
      case NeighborsOptions::kRadius:
        *out++ = share(other.radius, o.radius_max, o.clip);
        break;
      case NeighborsOptions::kRadii:
        *out++ = share(other.radius + seen.radius, o.radius_max, o.clip);
        break;
      case NeighborsOptions::kDistance:
        *out++ = share(norm(away), o.distance_max, o.clip);
        break;
      case NeighborsOptions::kGap:
        *out++ = share(gap, o.distance_max, o.clip);
        break;
      case NeighborsOptions::kExtent:
        *out++ = share(other.extent, o.radius_max, o.clip);
        break;
      case NeighborsOptions::kOwnExtent:
        *out++ = share(other.own_extent, o.radius_max, o.clip);
        break;
      case NeighborsOptions::kExtentGap:
        *out++ = share(norm(away) - other.extent - other.own_extent, o.distance_max, o.clip);
        break;
      case NeighborsOptions::kNearness:
        *out++ = networks::exponential(-std::max(gap, 0.0) / o.decay);
        break;
      case NeighborsOptions::kGoalDistance:
        *out++ = share(seen.has_goal() ? norm(seen.goal.position() - other.position) : 0.0, o.distance_max, o.clip);
        break;
      case NeighborsOptions::kArrived:
        *out++ = other.arrived;
        break;
      case NeighborsOptions::kRobot:
        *out++ = other.is_robot;
        break;
      case NeighborsOptions::kPresent:
        *out++ = 1.0;
        break;
    }
  }
}

inline void neighbors(const NeighborsOptions& o, const Seen& seen, double* out, std::uint8_t* mask) {
  const Vec2 axis = x_axis(o.frame, seen);
  const std::size_t count = o.count, size = o.features.size();
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t place = o.nearest_last ? count - 1 - k : k;
    double* const numbers = out + place * size;
    bool present = k < seen.neighbor_count && seen.neighbors[k].present;
    if (present) {
      const Neighbor& other = seen.neighbors[k];
      const double gap = norm(other.position - seen.pose.position()) - (other.radius + seen.radius);
      present = !(o.range && !(gap <= *o.range));
      if (present) neighbor(o, seen, other, axis, gap, numbers);
    }
    if (!present) std::fill(numbers, numbers + size, 0.0);
    mask[place] = present;
  }
}

}  // namespace irsim
