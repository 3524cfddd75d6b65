// ease: straight to the goal, and slower the nearer the goal is; avoids nothing.
#pragma once

#include "decision.hpp"
#include "fields.hpp"

namespace irsim {

struct EaseOptions {
  double slow_radius;  // distance to the goal below which the speed falls [m]
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("slow_radius", &EaseOptions::slow_radius));
  }
};

inline void ease(const EaseOptions& options, const Decision& decision, Intent* intents) {
  const World& world = decision.world;
  for (int k = 0; k < decision.count; ++k) {
    const int i = decision.objects[k], row = decision.row(k);
    const Goal& goal = decision.state.destination(row);
    if (std::isnan(goal.x)) {
      intents[k] = Intent::of_control({});
      continue;
    }
    const Vec2 way = goal.position() - decision.state.pose[row].position();
    const double distance = norm(way);
    const double speed = world.vel_max[i][0] * std::min(1.0, distance / options.slow_radius);
    intents[k] = Intent::of_velocity(distance > world.goal_threshold[i] ? way * (speed / distance) : Vec2{});
  }
}

}  // namespace irsim
