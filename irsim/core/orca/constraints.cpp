#include "orca/constraints.hpp"

namespace irsim {
namespace {

Vec2 left_of(Vec2 a) { return {-a.y, a.x}; }
Vec2 right_of(Vec2 a) { return {a.y, -a.x}; }
Vec2 normalized(Vec2 a) { return a * (1.0 / norm(a)); }

/// Unit vectors from the origin along both tangents of a disc that does not contain it.
struct Tangents {
  Vec2 left, right;
};
inline Tangents tangents(Vec2 centre, double radius) {
  const double distance2 = squared(centre), leg = std::sqrt(std::max(distance2 - radius * radius, 0.0));
  const double scale = 1.0 / distance2;
  const Vec2 along = centre * (leg * scale), aside = left_of(centre) * (radius * scale);
  return {along + aside, along - aside};
}

/// The half-plane of velocities that lead away from an obstacle that the agent touches. It includes zero.
HalfPlane away_from(Vec2 offset) {
  const double length = norm(offset);
  return {{}, length > 0.0 ? left_of(offset) * (1.0 / length) : Vec2{0.0, 1.0}};
}

/// The tangent to a disc of velocities at its point nearest to `velocity`.
HalfPlane tangent_to_disc(Vec2 centre, double radius, Vec2 velocity) {
  const Vec2 out = normalized(velocity - centre);
  return {centre + out * radius, right_of(out)};
}

}  // namespace

void avoid_agent(const OrcaAgent& agent, const OrcaAgent& other, double share, double horizon, double dt, bool first,
                 HalfPlane& plane) {
  const Vec2 offset = other.position - agent.position, velocity = agent.velocity - other.velocity;
  const double distance2 = squared(offset), radius = agent.radius + other.radius;
  const bool apart = distance2 > radius * radius;
  const double rate = 1.0 / (apart ? horizon : dt);
  const Vec2 relative = velocity - offset * rate;  // relative to the centre of the disc that truncates the cone
  const double length2 = squared(relative), ahead = dot(relative, offset);
  Vec2 change;  // smallest change of the relative velocity
  if (!apart || (ahead < 0.0 && ahead * ahead > radius * radius * length2)) {
    const double length = std::sqrt(length2);
    const Vec2 out = length > 0.0 ? relative * (1.0 / length) : Vec2{first ? 1.0 : -1.0, 0.0};
    plane.direction = right_of(out);
    change = out * (radius * rate - length);
  } else {
    const Tangents legs = tangents(offset, radius);
    plane.direction = cross(offset, relative) > 0.0 ? legs.left : legs.right * -1.0;
    change = plane.direction * dot(velocity, plane.direction) - velocity;
  }
  plane.point = agent.velocity + change * share;
}

HalfPlane avoid_disc(const OrcaAgent& agent, Vec2 centre, double radius, double horizon) {
  const Vec2 offset = centre - agent.position;
  const double sum = agent.radius + radius;
  if (squared(offset) <= sum * sum) return away_from(offset);
  HalfPlane plane;
  avoid_agent(agent, {centre, {}, radius}, 1.0, horizon, horizon, true, plane);
  return plane;
}

bool avoid_edge(const OrcaAgent& agent, const Edge& edge, double horizon, HalfPlane& out) {
  const double radius = agent.radius, radius2 = radius * radius, rate = 1.0 / horizon;
  const Vec2 to_left = edge.left.point - agent.position, to_right = edge.right.point - agent.position;
  const Vec2 along = edge.right.point - edge.left.point;
  const double nearest = -dot(to_left, along) / squared(along);  // 0 at the left end, 1 at the right end
  const bool on_line = squared(to_left + along * nearest) <= radius2;

  // The agent touches the edge, so the nearest feature decides.
  if (nearest < 0.0 && squared(to_left) <= radius2) {
    if (edge.left.convex) out = away_from(to_left);
    return edge.left.convex;
  }
  if (nearest > 1.0 && squared(to_right) <= radius2) {
    // The next edge begins here. If it faces the agent, its half-plane covers this corner.
    if (!edge.right.convex || cross(to_right, edge.right.out) < 0.0) return false;
    out = away_from(to_right);
    return true;
  }
  if (nearest >= 0.0 && nearest <= 1.0 && on_line) {
    out = {{}, edge.direction() * -1.0};
    return true;
  }

  // Of an edge seen from its end, only the nearer corner matters.
  const Corner* left = &edge.left;
  const Corner* right = &edge.right;
  if (on_line) (nearest < 0.0 ? right = left : left = right);
  const bool single = left == right;
  if (single && !left->convex) return false;

  // The legs of the cone. At corners that are not convex they extend the edge.
  Vec2 left_leg = edge.direction() * -1.0, right_leg = edge.direction();
  if (left->convex) left_leg = tangents(left->point - agent.position, radius).left;
  if (right->convex) right_leg = tangents(right->point - agent.position, radius).right;
  // A leg that would point into the neighboring edge is left to that edge.
  bool foreign_left = false, foreign_right = false;
  if (left->convex && cross(left_leg, left->in * -1.0) >= 0.0) {
    left_leg = left->in * -1.0;
    foreign_left = true;
  }
  if (right->convex && cross(right_leg, right->out) <= 0.0) {
    right_leg = right->out;
    foreign_right = true;
  }

  // The cone is truncated by the edge relative to the agent, scaled by 1 / horizon.
  const Vec2 left_end = (left->point - agent.position) * rate, right_end = (right->point - agent.position) * rate;
  const Vec2 from_left = agent.velocity - left_end, from_right = agent.velocity - right_end;
  const Vec2 front = right_end - left_end;
  const double t = single ? 0.5 : dot(from_left, front) / squared(front);
  const double t_left = dot(from_left, left_leg), t_right = dot(from_right, right_leg);
  if ((t < 0.0 && t_left < 0.0) || (single && t_left < 0.0 && t_right < 0.0)) {
    out = tangent_to_disc(left_end, radius * rate, agent.velocity);
    return true;
  }
  if (t > 1.0 && t_right < 0.0) {
    out = tangent_to_disc(right_end, radius * rate, agent.velocity);
    return true;
  }
  const double to_front = t < 0.0 || t > 1.0 || single ? kInfinity : squared(from_left - front * t);
  const double to_left_leg = t_left < 0.0 ? kInfinity : squared(from_left - left_leg * t_left);
  const double to_right_leg = t_right < 0.0 ? kInfinity : squared(from_right - right_leg * t_right);
  if (to_front <= to_left_leg && to_front <= to_right_leg) {
    out.direction = edge.direction() * -1.0;
    out.point = left_end + left_of(out.direction) * (radius * rate);
    return true;
  }
  if (to_left_leg <= to_right_leg) {
    out.direction = left_leg;
    out.point = left_end + left_of(out.direction) * (radius * rate);
    return !foreign_left;
  }
  out.direction = right_leg * -1.0;
  out.point = right_end + left_of(out.direction) * (radius * rate);
  return !foreign_right;
}

}  // namespace irsim
