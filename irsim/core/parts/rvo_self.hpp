// The robot itself as RL-RVO observes it.
#pragma once

#include <optional>

#include "fields.hpp"
#include "observing.hpp"
#include "parts/rvo_cones.hpp"

namespace irsim {

struct RvoSelfOptions {
  std::optional<double> speed;  // of the desired velocity; none: the upper limit of the first control [m/s]
  double margin;                // added to the robot's own radius [m]
  std::optional<int> decimals;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using O = RvoSelfOptions;
    return visit(field("speed", &O::speed), field("margin", &O::margin), field("decimals", &O::decimals));
  }
};

inline std::size_t members(const RvoSelfOptions&) { return 0; }
inline std::size_t width(const RvoSelfOptions&) { return 6; }

inline void rvo_self(const RvoSelfOptions& o, const Seen& seen, double* out, std::uint8_t*) {
  const double limit = o.speed.value_or(seen.high[0]), speed = std::isfinite(limit) ? limit : 1.0;
  const Vec2 offset = seen.to_goal();
  const double distance = norm(offset);
  const Vec2 desired = distance > seen.goal_threshold ? offset * (speed / distance) : Vec2{};
  const double numbers[] = {seen.velocity.x, seen.velocity.y,       desired.x,
                            desired.y,       wrap(seen.pose.theta), seen.radius + o.margin};
  for (const double number : numbers) *out++ = rounded(number, o.decimals);
}

}  // namespace irsim
