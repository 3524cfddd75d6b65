#include "orca/half_planes.hpp"

namespace irsim {
namespace {

constexpr double kParallel = 1e-9;  // sine of the angle between lines that count as parallel
constexpr double kSlack = 1e-10;    // rounding errors up to this size do not make a program infeasible [m/s]

/// The objective of a program: the velocity nearest to `target`, or the one farthest along the unit vector `target`.
struct Aim {
  Vec2 target;
  bool farthest;
};

/// Find the best velocity on the line of plane `k` within the planes before it. Returns false if there is no such
/// velocity.
bool best_on_line(const HalfPlane* planes, int k, double max_speed, const Aim& aim, Vec2& velocity) {
  const HalfPlane& line = planes[k];
  const double along = dot(line.point, line.direction), across = cross(line.point, line.direction);
  const double half2 = max_speed * max_speed - across * across;  // half the chord of the disc of speeds, squared
  if (half2 < -kSlack) return false;
  const double half = std::sqrt(std::max(half2, 0.0));
  double low = -along - half, high = -along + half;
  for (int i = 0; i < k; ++i) {
    const double sine = cross(line.direction, planes[i].direction);
    const double depth = planes[i].depth(line.point);
    if (std::fabs(sine) <= kParallel) {
      if (depth < -kSlack) return false;
      continue;
    }
    const double t = depth / sine;
    if (sine > 0.0) {
      high = std::min(high, t);
    } else {
      low = std::max(low, t);
    }
    if (low > high + kSlack) return false;
  }
  double t;
  if (aim.farthest) {
    t = dot(aim.target, line.direction) > 0.0 ? high : low;
  } else {
    t = clip(dot(line.direction, aim.target - line.point), low, high);
  }
  velocity = line.point + line.direction * t;
  return true;
}

/// Find the best velocity within all planes. Returns the number of planes, or the index of the first plane that makes
/// the program infeasible; `velocity` is then the best one within the planes before it.
int best_velocity(const HalfPlane* planes, int count, double max_speed, const Aim& aim, Vec2& velocity) {
  const double length2 = squared(aim.target);
  if (aim.farthest) {
    velocity = aim.target * max_speed;
  } else {
    velocity = length2 > max_speed * max_speed ? aim.target * (max_speed / std::sqrt(length2)) : aim.target;
  }
  for (int k = 0; k < count; ++k) {
    if (planes[k].depth(velocity) >= 0.0) continue;
    const Vec2 before = velocity;
    if (!best_on_line(planes, k, max_speed, aim, velocity)) {
      velocity = before;
      return k;
    }
  }
  return count;
}

/// Find the half-plane of velocities that violate `b` no more than they violate `a`. Returns false if all do.
bool no_worse(const HalfPlane& a, const HalfPlane& b, HalfPlane& out) {
  const double sine = cross(a.direction, b.direction);
  if (std::fabs(sine) <= kParallel) {
    if (dot(a.direction, b.direction) > 0.0) return false;
    out.point = (a.point + b.point) * 0.5;
  } else {
    out.point = a.point + a.direction * (cross(b.direction, a.point - b.point) / sine);
  }
  const Vec2 across = b.direction - a.direction;
  out.direction = across * (1.0 / norm(across));
  return true;
}

/// Minimise the largest violation of planes[hard:] (the 3-D program), starting with the best velocity within the planes
/// before `first`.
void least_violation(const HalfPlane* planes, int count, int hard, int first, double max_speed,
                     std::vector<HalfPlane>& scratch, Vec2& velocity) {
  double violation = 0.0;
  for (int k = first; k < count; ++k) {
    if (-planes[k].depth(velocity) <= violation) continue;
    scratch.assign(planes, planes + hard);
    for (int i = hard; i < k; ++i) {
      HalfPlane bound;
      if (no_worse(planes[k], planes[i], bound)) scratch.push_back(bound);
    }
    const Vec2 before = velocity, inward = {-planes[k].direction.y, planes[k].direction.x};
    const int size = static_cast<int>(scratch.size());
    // This fails only by rounding errors; the velocity so far is then the result.
    if (best_velocity(scratch.data(), size, max_speed, {inward, true}, velocity) < size) velocity = before;
    violation = -planes[k].depth(velocity);
  }
}

}  // namespace

bool choose_velocity(const HalfPlane* planes, int count, int hard, double max_speed, Vec2 preferred,
                     std::vector<HalfPlane>& scratch, Vec2& velocity) {
  const int met = best_velocity(planes, count, max_speed, {preferred, false}, velocity);
  if (met == count) return true;
  least_violation(planes, count, hard, met, max_speed, scratch, velocity);
  return false;
}

}  // namespace irsim
