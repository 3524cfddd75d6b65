#include "surroundings/sidestep.hpp"

#include "surroundings/ties.hpp"

namespace irsim {
namespace {

constexpr double kLookAhead = 10.0;  // objects farther ahead are not in the way [m]
constexpr double kSlow = 0.3;        // share of the wanted speed below which an object turns further
constexpr double kMostTurn = 90.0;   // angle at a stand [degrees]

}  // namespace

Vec2 sidestepped(const Decision& decision, int k, Vec2 wanted, double angle) {
  if (angle == 0.0) return wanted;
  const double speed = norm(wanted);
  if (!(speed > 0.0)) return wanted;
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
  if (!blocked) return wanted;
  const double standing = 1.0 - std::min(1.0, norm(ego.velocity) / (kSlow * speed));
  const double turn = std::fabs(angle) + std::max(0.0, kMostTurn - std::fabs(angle)) * standing;
  return rotate(wanted, unit(-std::copysign(turn, angle) * (kPi / 180.0)));
}

}  // namespace irsim
