#include "surroundings/ties.hpp"

#include "world/state.hpp"

namespace irsim {
namespace {

constexpr double kAlmost = 1.0 + 1e-9;  // so that rounding does not decide
constexpr double kArrived = 0.1;        // objects nearer to their goal than this have no direction [m]

/// Whether b is the mirror image of a about a line across the unit vector `n`.
bool mirrors(Vec2 a, Vec2 b, Vec2 n, double tolerance) {
  return std::fabs(dot(a + b, n)) <= tolerance && std::fabs(cross(n, a - b)) <= tolerance;
}

}  // namespace

std::optional<double> mirrored(const State& state, const MirrorPair& pair) {
  const Vec2 here = state.pose[pair.row].position(), there = state.pose[pair.other].position();
  const Vec2 offset = there - here, way = state.destination(pair.row).position() - here;
  const double gap = norm(offset);
  if (!(gap > 0.0)) return std::nullopt;
  const Vec2 n = offset * (1.0 / gap);
  if (!mirrors(pair.velocity, pair.its_velocity, n, pair.tolerance)) return std::nullopt;
  const Vec2 its_way = state.destination(pair.other).position() - there;
  const double far = norm(way), its_far = norm(its_way);
  if (!(far > kArrived && its_far > kArrived)) return std::nullopt;
  const Vec2 ahead = way * (1.0 / far);
  if (!mirrors(ahead, its_way * (1.0 / its_far), n, pair.direction)) return std::nullopt;
  const double closing = 2.0 * dot(ahead, n);  // per metre that both move: mirrored ways meet midway
  const bool meet = closing * kTieHorizon * pair.speed > gap && gap - closing * std::min(far, its_far) < pair.lane;
  return meet ? std::optional<double>(cross(ahead, n)) : std::nullopt;
}

bool is_tied(const Decision& decision, const Ego& ego, const Disc& other, double tolerance, double direction) {
  if (decision.world.is_static[other.object]) return false;
  const State& state = decision.state;
  const int row = decision.first_row + other.object;
  const double lane = ego.radius + other.radius + kPadding + kLaneMargin, speed = norm(ego.desired);
  const Vec2 offset = state.pose[row].position() - ego.position;
  const Vec2 to_goal = state.destination(ego.row).position() - ego.position;
  // As in `mirrored`, but with one root only: most pairs end here.
  const double soon = kAlmost * 2.0 * kTieHorizon * speed;
  if (!(soon * dot(to_goal, offset) >= squared(offset) * norm(to_goal))) return false;
  return mirrored(state, {ego.row, row, ego.velocity, other.velocity, speed, lane, tolerance, direction}).has_value();
}

}  // namespace irsim
