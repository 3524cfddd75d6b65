// replay: be where a recording says, at its times. Drives that move in every direction are exactly there.
#pragma once

#include <algorithm>
#include <type_traits>

#include "decision.hpp"
#include "fields.hpp"

namespace irsim {

enum class Interpolation { linear, cubic };

struct ReplayOptions {
  std::vector<double> times;               // increasing [s]
  std::vector<std::vector<double>> poses;  // x, y [m] and perhaps heading [rad], one for each time
  Interpolation interpolation;
  bool vanish;  // whether an obstacle is not in the world before the first and after the last time
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("times", &ReplayOptions::times), field("poses", &ReplayOptions::poses),
                 choice("interpolation", &ReplayOptions::interpolation, "linear", "cubic"),
                 field("vanish", &ReplayOptions::vanish));
  }
};

/// Speed below which a recorded object stands and keeps its heading [m/s].
constexpr double kReplayRest = 1e-6;

/// Where a recording is at a time [s]: the first and the last pose hold before and after it. Without recorded headings
/// the object looks where it goes, and in the direction `heading` while it stands.
inline Pose replayed(const ReplayOptions& options, double time, double heading) {
  const auto& times = options.times;
  const int last = static_cast<int>(times.size()) - 1;
  const auto point = [&](int k) { return Vec2{options.poses[k][0], options.poses[k][1]}; };
  const auto slope = [&](int a, int b) { return (point(b) - point(a)) * (1.0 / (times[b] - times[a])); };
  const int after = static_cast<int>(std::upper_bound(times.begin(), times.end(), time) - times.begin());
  const int k = std::clamp(after - 1, 0, std::max(0, last - 1)), next = std::min(k + 1, last);
  const double length = times[next] - times[k];
  const double s = length > 0.0 ? std::clamp((time - times[k]) / length, 0.0, 1.0) : 0.0;
  const Vec2 from = point(k), to = point(next);
  Vec2 where = from * (1.0 - s) + to * s, velocity;
  if (length > 0.0) {
    velocity = slope(k, next);
    if (options.interpolation == Interpolation::cubic) {  // Hermite, with the slopes of Catmull and Rom
      const Vec2 m0 = slope(std::max(k - 1, 0), next) * length, m1 = slope(k, std::min(next + 1, last)) * length;
      const double r = 1.0 - s;
      where = from * (r * r * (1.0 + 2.0 * s)) + to * (s * s * (1.0 + 2.0 * r)) + m0 * (r * r * s) - m1 * (s * s * r);
      velocity = ((to - from) * (6.0 * r * s) + m0 * (r * (r - 2.0 * s)) + m1 * (s * (s - 2.0 * r))) * (1.0 / length);
    }
  }
  Pose pose{where.x, where.y, heading};
  if (options.poses[k].size() > 2 && options.poses[next].size() > 2) {
    pose.theta = wrap(options.poses[k][2] + wrap(options.poses[next][2] - options.poses[k][2]) * s);
  } else if (norm(velocity) > kReplayRest) {
    pose.theta = std::atan2(velocity.y, velocity.x);
  }
  return pose;
}

inline void replay(const ReplayOptions& options, const Decision& decision, Intent* intents) {
  const World& world = decision.world;
  const double rate = 1.0 / world.step_time;
  const double time = static_cast<double>(decision.state.count[decision.w()] + 1) * world.step_time;
  for (int k = 0; k < decision.count; ++k) {
    const int row = decision.row(k);
    const Pose& pose = decision.state.pose[row];
    if (options.times.empty()) {
      intents[k] = Intent::of_control({});
      continue;
    }
    const Pose next = replayed(options, time, pose.theta);
    const Vec2 velocity = (next.position() - pose.position()) * rate;
    intents[k] = Intent::of_velocity(velocity);
    if (!std::holds_alternative<OmniAngularOptions>(world.drive[decision.objects[k]])) continue;
    const Vec2 body = unrotate(velocity, decision.state.heading(row));
    intents[k] = Intent::of_control({{body.x, body.y, wrap(next.theta - pose.theta) * rate}});
  }
}

}  // namespace irsim
