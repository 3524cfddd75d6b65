#include "surroundings/sidestep.hpp"

#include "surroundings/ego.hpp"

namespace irsim {
namespace {

constexpr double kLookAhead = 10.0;  // objects farther ahead are not in the way [m]
constexpr double kLaneMargin = 0.1;  // margin on either side of the lane [m]

}  // namespace

Vec2 sidestepped(const Decision& decision, int k, Vec2 wanted, double angle) {
  const double speed = norm(wanted);
  if (angle == 0.0 || !(speed > 0.0)) return wanted;
  const Ego ego = ego_of(decision, k);
  const Goal& goal = decision.state.goal[ego.row];
  const Vec2 ahead = wanted * (1.0 / speed);
  const double reach = std::min(kLookAhead, norm(goal.position() - ego.position));
  bool blocked = false;
  for_discs(decision, ego, reach, [&](const Disc& other) {
    if (decision.world.is_static[other.object]) return;
    const Vec2 offset = other.centre - ego.position;
    const double lane = ego.radius + other.radius + kPadding + kLaneMargin;
    blocked = blocked || (dot(offset, ahead) > 0.0 && std::fabs(cross(ahead, offset)) < lane);
  });
  return blocked ? rotate(wanted, unit(-angle * (kPi / 180.0))) : wanted;
}

}  // namespace irsim
