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
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using O = NeighborsOptions;
    return visit(choices("features", &O::features, "x", "y", "vx", "vy", "heading_cos", "heading_sin", "radius",
                         "radii", "distance", "gap", "extent", "own_extent", "extent_gap", "nearness", "goal_distance",
                         "arrived", "robot", "present"),
                 field("count", &O::count), field("range", &O::range), field("nearest_last", &O::nearest_last),
                 choice("frame", &O::frame, "own", "goal", "world"), field("relative_velocity", &O::relative_velocity),
                 field("distance_max", &O::distance_max), field("speed_max", &O::speed_max),
                 field("radius_max", &O::radius_max), field("decay", &O::decay), field("clip", &O::clip));
  }
};

inline std::size_t members(const NeighborsOptions& o) { return o.count; }
inline std::size_t width(const NeighborsOptions& o) { return o.features.size(); }

/// Another object in the frame of an observation, and where its numbers go.
struct RelativeNeighbor {
  const Neighbor* other;
  double* out;
  Vec2 position, velocity;
  double distance, gap;
};

/// Write the numbers of several neighbors, feature by feature.
inline void write_features(const NeighborsOptions& o, const Seen& seen, Vec2 axis, const RelativeNeighbor* all,
                           std::size_t count) {
  for (std::size_t f = 0; f < o.features.size(); ++f) {
    const auto each = [&](auto&& value) {
      for (std::size_t k = 0; k < count; ++k) all[k].out[f] = value(all[k], *all[k].other);
    };
    using R = RelativeNeighbor;
    using N = Neighbor;
    switch (o.features[f]) {
      case NeighborsOptions::kX:
        each([&](const R& r, const N&) { return share(r.position.x, o.distance_max, o.clip); });
        break;
      case NeighborsOptions::kY:
        each([&](const R& r, const N&) { return share(r.position.y, o.distance_max, o.clip); });
        break;
      case NeighborsOptions::kVx:
        each([&](const R& r, const N&) { return share(r.velocity.x, o.speed_max, o.clip); });
        break;
      case NeighborsOptions::kVy:
        each([&](const R& r, const N&) { return share(r.velocity.y, o.speed_max, o.clip); });
        break;
      case NeighborsOptions::kHeadingCos:
        each([&](const R&, const N& n) { return facing(n.ahead, axis).x; });
        break;
      case NeighborsOptions::kHeadingSin:
        each([&](const R&, const N& n) { return facing(n.ahead, axis).y; });
        break;
      case NeighborsOptions::kRadius:
        each([&](const R&, const N& n) { return share(n.radius, o.radius_max, o.clip); });
        break;
      case NeighborsOptions::kRadii:
        each([&](const R&, const N& n) { return share(n.radius + seen.radius, o.radius_max, o.clip); });
        break;
      case NeighborsOptions::kDistance:
        each([&](const R& r, const N&) { return share(r.distance, o.distance_max, o.clip); });
        break;
      case NeighborsOptions::kGap:
        each([&](const R& r, const N&) { return share(r.gap, o.distance_max, o.clip); });
        break;
      case NeighborsOptions::kExtent:
        each([&](const R&, const N& n) { return share(n.extent, o.radius_max, o.clip); });
        break;
      case NeighborsOptions::kOwnExtent:
        each([&](const R&, const N& n) { return share(n.own_extent, o.radius_max, o.clip); });
        break;
      case NeighborsOptions::kExtentGap:
        each([&](const R& r, const N& n) {
          return share(r.distance - n.extent - n.own_extent, o.distance_max, o.clip);
        });
        break;
      case NeighborsOptions::kNearness:
        each([&](const R& r, const N&) { return networks::exponential(-std::max(r.gap, 0.0) / o.decay); });
        break;
      case NeighborsOptions::kGoalDistance:
        each([&](const R&, const N& n) {
          return share(seen.has_goal() ? norm(seen.goal.position() - n.position) : 0.0, o.distance_max, o.clip);
        });
        break;
      case NeighborsOptions::kArrived:
        each([&](const R&, const N& n) { return n.arrived; });
        break;
      case NeighborsOptions::kRobot:
        each([&](const R&, const N& n) { return n.is_robot; });
        break;
      case NeighborsOptions::kPresent:
        each([&](const R&, const N&) { return 1.0; });
        break;
    }
  }
}

inline void neighbors(const NeighborsOptions& o, const Seen& seen, double* out, std::uint8_t* mask) {
  constexpr std::size_t kMost = 16;  // neighbors that are written together
  const Vec2 axis = x_axis(o.frame, seen);
  const std::size_t count = o.count, size = o.features.size();
  RelativeNeighbor found[kMost];
  std::size_t known = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t place = o.nearest_last ? count - 1 - k : k;
    double* const numbers = out + place * size;
    bool present = k < seen.neighbor_count && seen.neighbors[k].present;
    if (present) {
      const Neighbor& other = seen.neighbors[k];
      const Vec2 away = other.position - seen.pose.position();
      const double distance = norm(away), gap = distance - (other.radius + seen.radius);
      present = !(o.range && !(gap <= *o.range));
      if (present) {
        const Vec2 velocity = o.relative_velocity ? other.velocity - seen.velocity : other.velocity;
        found[known++] = {&other, numbers, unrotate(away, axis), unrotate(velocity, axis), distance, gap};
      }
    }
    if (!present) std::fill(numbers, numbers + size, 0.0);
    mask[place] = present;
    if (known < kMost && k + 1 < count) continue;
    write_features(o, seen, axis, found, known);
    known = 0;
  }
}

}  // namespace irsim
