#include "surroundings/closing.hpp"

#include <algorithm>

#include "surroundings/ego.hpp"
#include "world/features.hpp"
#include "world/scene.hpp"

namespace irsim {
namespace {

constexpr double kKept = 0.01;            // part of a gap that is never taken [m]
constexpr double kSpeedRounding = 1e-12;  // smaller differences of speeds are rounding errors [m/s]
constexpr double kAlong = 1e-9;           // a smaller sine of the angle to a tangent is a rounding error

bool is_round(const Decision& decision, int object) {
  const Shapes& shapes = *decision.state.scenes[decision.w()].shapes;
  return shapes.part_count(object) == 1 && shapes.parts[shapes.body[object].part].kind == Kind::circle;
}

/// Largest speed in a direction at which no more than the share of any gap is taken in one step [m/s].
///
/// Args:
///   direction: Of the motion at the start of the step, a unit vector.
///   turn_rate: At which the object may turn within the step [rad/s].
double largest_speed(const std::vector<Nearby>& nearby, const World& world, Vec2 direction, double turn_rate) {
  const double turn = world.integration == kExact ? 0.5 * turn_rate * world.step_time : 0.0;
  double speed = kInfinity;
  for (const Nearby& other : nearby) {
    const double closing = dot(direction, other.towards) + turn;
    if (closing > kAlong) speed = std::min(speed, kClosingShare * other.gap / (closing * world.step_time));
  }
  return speed;
}

/// A velocity without what takes more than the share of a gap. Limits of the drive would change the direction of one
/// that is faster than `fastest` [m/s]. The largest excess goes first, of equal ones that on the left: so the order of
/// the file does not matter.
Vec2 slide_along(const std::vector<Nearby>& nearby, const World& world, Vec2 velocity, double fastest) {
  const double wanted = norm(velocity);
  if (wanted > fastest) velocity = velocity * (fastest / wanted);
  for (std::size_t k = 0; k < nearby.size(); ++k) {
    const Nearby* worst = nullptr;
    double most = kSpeedRounding;
    for (const Nearby& other : nearby) {
      const double excess = dot(velocity, other.towards) - kClosingShare * other.gap / world.step_time;
      const bool equal = worst != nullptr && std::fabs(excess - most) <= kSpeedRounding;
      if (equal ? cross(velocity, other.towards) > cross(velocity, worst->towards) : excess > most) {
        worst = &other, most = excess;
      }
    }
    if (worst == nullptr) break;
    velocity = velocity - worst->towards * most;
  }
  const double speed = norm(velocity);
  if (!(speed > 0.0)) return velocity;
  const double most = largest_speed(nearby, world, velocity * (1.0 / speed), 0.0);
  return speed > most ? velocity * (most / speed) : velocity;
}

}  // namespace

void add_nearby(const Decision& decision, const Ego& ego, const Disc& disc) {
  const World& world = decision.world;
  const Vec2 way = disc.centre - ego.position;
  const double touching = ego.radius - kPadding + disc.radius;
  if (world.unobstructed[disc.object] || world.unobstructed[ego.id]) return;
  const double distance = norm(way);
  if (!(distance > 0.0) || !is_round(decision, ego.id) || !is_round(decision, disc.object)) return;
  decision.work.nearby.push_back({way * (1.0 / distance), std::max(distance - touching - kKept, 0.0)});
}

void keep_gaps(const Decision& decision, const Ego& ego, bool slides, Intent& intent) {
  const std::vector<Nearby>& nearby = decision.work.nearby;
  const World& world = decision.world;
  const Vec3& top = decision.state.vel_max[ego.row];
  int travel = 1;
  with(world.drive[ego.id], [&](const auto& options) { travel = rows(options).travel; });
  const double fastest = travel > 1 ? std::min(top[0], top[1]) : top[0];
  if (slides || travel > 1) {
    const Vec2 wanted = intent.velocity;
    intent.velocity = slide_along(nearby, world, wanted, fastest);
    // Where nothing is left of a gap, a heading that is nearly along it leads nowhere, however small the error.
    if (std::fabs(cross(wanted, intent.velocity)) > kSpeedRounding) intent.turning.tolerance = 0.0;
  }
  if (travel > 1) return;
  const double most = largest_speed(nearby, world, decision.state.heading(ego.row), top[1]);
  intent.turning.max_forward = std::min(intent.turning.max_forward, most);
}

bool keeps_gaps(const Decision& decision, const Ego& ego, std::optional<bool> chosen) {
  return chosen.value_or(decision.world.is_robot[ego.id] != 0);
}

}  // namespace irsim
