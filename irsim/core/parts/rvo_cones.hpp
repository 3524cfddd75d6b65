// Reciprocal velocity obstacles of the neighbors, a set of `count` members with the most urgent one last.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "fields.hpp"
#include "observing.hpp"

namespace irsim {

struct RvoConesOptions {
  enum Velocity { kCommanded, kPresent };
  int count;          // most members
  int nearest;        // neighbors that are looked at
  double range;       // largest distance of a neighbor [m]
  double margin;      // added to the robot's own radius [m]
  double horizon;     // times to a collision from here on count as never [s]
  Velocity velocity;  // whose collision is timed
  std::optional<int> decimals;
  bool zero_row;  // whether a robot without neighbors sees one member of zeros
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using O = RvoConesOptions;
    return visit(field("count", &O::count), field("nearest", &O::nearest), field("range", &O::range),
                 field("margin", &O::margin), field("horizon", &O::horizon),
                 choice("velocity", &O::velocity, "commanded", "present"), field("decimals", &O::decimals),
                 field("zero_row", &O::zero_row));
  }
};

constexpr std::size_t kConeNumbers = 8;

inline std::size_t members(const RvoConesOptions& o) { return o.count; }
inline std::size_t width(const RvoConesOptions&) { return kConeNumbers; }

/// A number rounded as `numpy.round` does: halves go to the even neighbor.
inline double rounded(double value, const std::optional<int>& decimals) {
  if (!decimals) return value;
  double scale = 1.0;
  for (int k = 0; k < *decimals; ++k) scale *= 10.0;
  return std::nearbyint(value * scale) / scale;
}

/// Time until a point that moves with `velocity` relative to a disc about the origin reaches it [s].
inline double time_to_disc(Vec2 position, Vec2 velocity, double radius) {
  const double a = squared(velocity), b = 2.0 * dot(position, velocity), c = squared(position) - radius * radius;
  if (c <= 0.0) return 0.0;
  const double root = b * b - 4.0 * a * c;
  if (root <= 0.0) return kInfinity;
  const double late = (-b + std::sqrt(root)) / (2.0 * a), early = (-b - std::sqrt(root)) / (2.0 * a);
  return std::min(late >= 0.0 ? late : kInfinity, early >= 0.0 ? early : kInfinity);
}

struct SeenCone {
  double numbers[kConeNumbers];  // apex, left leg, right leg, distance, urgency
};

/// The cone of one neighbor: after van den Berg et al. (2008), or the velocity obstacle of one that stands still.
inline SeenCone cone_of(const RvoConesOptions& o, const Seen& seen, const Neighbor& other, Vec2 away, double distance) {
  const double reach = seen.radius + o.margin + other.radius, far = std::max(distance, reach);
  const double sine = reach / far, cosine = std::sqrt(std::max(0.0, 1.0 - sine * sine));
  const Vec2 ahead = away * (1.0 / distance);
  const Vec2 left = rotate(ahead, {cosine, sine}), right = rotate(ahead, {cosine, -sine});
  const bool still = other.velocity.x == 0.0 && other.velocity.y == 0.0;
  const Vec2 apex = still ? other.velocity : (seen.velocity + other.velocity) * 0.5;
  const Vec2 wanted = o.velocity == RvoConesOptions::kCommanded ? seen.commanded : seen.velocity;
  const Vec2 inside = wanted - apex;
  double time = kInfinity;
  if (cross(left, inside) <= 0.0 && cross(right, inside) >= 0.0) {
    const Vec2 relative = still ? wanted - other.velocity : wanted * 2.0 - other.velocity - seen.velocity;
    time = time_to_disc(away * -1.0, relative, reach);
    if (!(time < o.horizon)) time = kInfinity;
  }
  return {{apex.x, apex.y, left.x, left.y, right.x, right.y, distance - other.radius, 1.0 / (time + 0.2)}};
}

inline void rvo_cones(const RvoConesOptions& o, const Seen& seen, double* out, std::uint8_t* mask) {
  const std::size_t count = o.count, looked_at = std::min<std::size_t>(o.nearest, seen.neighbor_count);
  std::vector<SeenCone> cones;
  cones.reserve(looked_at);
  for (std::size_t k = 0; k < looked_at; ++k) {
    const Neighbor& other = seen.neighbors[k];
    if (!other.present) continue;
    const Vec2 away = other.position - seen.pose.position();
    const double distance = norm(away);
    if (distance > 0.0 && distance <= o.range) cones.push_back(cone_of(o, seen, other, away, distance));
  }
  std::stable_sort(cones.begin(), cones.end(), [](const SeenCone& a, const SeenCone& b) {
    return a.numbers[7] != b.numbers[7] ? a.numbers[7] < b.numbers[7] : a.numbers[6] > b.numbers[6];
  });
  const std::size_t kept = std::min(count, cones.size()), absent = count - kept;
  std::fill(out, out + absent * kConeNumbers, 0.0);
  std::fill(mask, mask + absent, std::uint8_t{0});
  for (std::size_t k = 0; k < kept; ++k) {
    const SeenCone& cone = cones[cones.size() - kept + k];
    for (std::size_t f = 0; f < kConeNumbers; ++f)
      out[(absent + k) * kConeNumbers + f] = rounded(cone.numbers[f], o.decimals);
    mask[absent + k] = 1;
  }
  if (kept == 0 && o.zero_row) mask[count - 1] = 1;
}

}  // namespace irsim
