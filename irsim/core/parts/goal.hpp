// Where the goal is, as seen from the robot.
#pragma once

#include <vector>

#include "fields.hpp"
#include "observing.hpp"

namespace irsim {

struct GoalOptions {
  enum Feature { kDistance, kNearness, kCos, kSin, kX, kY, kHeadingCos, kHeadingSin, kThreshold, kPresent };
  std::vector<Feature> features;
  Frame frame;
  double distance_max, decay;  // [m]
  bool clip;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using O = GoalOptions;
    return visit(choices("features", &O::features, "distance", "nearness", "cos", "sin", "x", "y", "heading_cos",
                         "heading_sin", "threshold", "present"),
                 choice("frame", &O::frame, "own", "goal", "world"), field("distance_max", &O::distance_max),
                 field("decay", &O::decay), field("clip", &O::clip));
  }
};

inline std::size_t members(const GoalOptions&) { return 0; }
inline std::size_t width(const GoalOptions& o) { return o.features.size(); }

inline void goal(const GoalOptions& o, const Seen& seen, double* out, std::uint8_t*) {
  const double there = seen.has_goal() ? 1.0 : 0.0;
  const Vec2 axis = x_axis(o.frame, seen), offset = seen.to_goal(), position = unrotate(offset, axis);
  const double distance = norm(offset);
  const Vec2 bearing = distance > 0.0 ? Vec2{position.x / distance, position.y / distance} : Vec2{1.0, 0.0};
  const auto heading = [&] {
    const bool wanted = std::isfinite(seen.goal.theta);
    return unrotate(unit(wanted ? seen.goal.theta : 0.0), axis) * (there * (wanted ? 1.0 : 0.0));
  };
  for (const auto feature : o.features) {
    switch (feature) {
      case GoalOptions::kDistance:
        *out++ = share(distance, o.distance_max, o.clip);
        break;
      case GoalOptions::kNearness:
        *out++ = networks::exponential(-distance / o.decay) * there;
        break;
      case GoalOptions::kCos:
        *out++ = clip(bearing.x * there, -1.0, 1.0);
        break;
      case GoalOptions::kSin:
        *out++ = clip(bearing.y * there, -1.0, 1.0);
        break;
      case GoalOptions::kX:
        *out++ = share(position.x, o.distance_max, o.clip);
        break;
      case GoalOptions::kY:
        *out++ = share(position.y, o.distance_max, o.clip);
        break;
      case GoalOptions::kHeadingCos:
        *out++ = clip(heading().x, -1.0, 1.0);
        break;
      case GoalOptions::kHeadingSin:
        *out++ = clip(heading().y, -1.0, 1.0);
        break;
      case GoalOptions::kThreshold:
        *out++ = share(seen.goal_threshold, o.distance_max, o.clip) * there;
        break;
      case GoalOptions::kPresent:
        *out++ = there;
        break;
    }
  }
}

}  // namespace irsim
