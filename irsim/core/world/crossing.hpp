// Starts and goals of objects that cross a circle or a square, as CrowdNav draws them (Chen et al., ICRA 2019).
#pragma once

#include <optional>

#include "random.hpp"
#include "world/placed_footprints.hpp"
#include "world/spec.hpp"

namespace irsim {

constexpr std::uint64_t kCrossingGoals = std::uint64_t{1} << 40;  // first block of draws for goals in a square
constexpr std::uint64_t kCrossingSide = std::uint64_t{1} << 41;   // block of the draw of the side

/// Footprints at the places of a scene: where objects start, and where they end.
struct CrossingPlaces {
  PlacedFootprints starts;
  std::optional<PlacedFootprints> ends;   // without a value if nothing crosses; objects that stand still are in both
  std::optional<PlacedFootprints> goals;  // the ends that are goals of objects that cross
};

struct Crossing {
  Pose start, goal;
  bool fits;  // whether there was room for both
};

/// A start near the circle and the goal opposite, both clear of all starts and goals.
inline Crossing draw_crossing(const CircleCrossing& entry, const Draws& draws, int attempts, int object, bool travels,
                              CrossingPlaces& placed) {
  const Vec2 center{entry.center[0], entry.center[1]};
  Crossing found{};
  for (int attempt = 0; attempt < attempts && !found.fits; ++attempt) {
    const auto u = draws.uniforms(static_cast<std::uint64_t>(attempt));
    const Vec2 noise{entry.noise * (2.0 * u[1] - 1.0), entry.noise * (2.0 * u[2] - 1.0)};
    const Vec2 offset = unit(kTurn * u[0]) * entry.radius + noise;
    const Vec2 start = center + offset, goal = center - offset;
    const double heading = wrap(std::atan2(-offset.y, -offset.x));
    found.start = {start.x, start.y, heading}, found.goal = {goal.x, goal.y, heading};
    const auto is_clear = [&](const Pose& pose) {
      return placed.starts.is_clear(object, pose, entry.clearance) &&
             placed.ends->is_clear(object, pose, entry.clearance);
    };
    found.fits = is_clear(found.start) && (!travels || is_clear(found.goal));
  }
  return found;
}

/// A start in one half of the square, clear of all starts, and a goal in the other half, clear of all goals.
inline Crossing draw_crossing(const SquareCrossing& entry, const Draws& draws, int attempts, int object, bool travels,
                              CrossingPlaces& placed) {
  const double side = draws.uniforms(kCrossingSide)[0] < 0.5 ? -1.0 : 1.0;
  const double heading = side < 0.0 ? 0.0 : -kPi;
  const auto draw = [&](std::uint64_t block, double half, PlacedFootprints& others, Pose& pose) {
    for (int attempt = 0; attempt < attempts; ++attempt) {
      const auto u = draws.uniforms(block + static_cast<std::uint64_t>(attempt));
      pose = {entry.center[0] + half * 0.5 * entry.width * u[0], entry.center[1] + entry.width * (u[1] - 0.5), heading};
      if (others.is_clear(object, pose, entry.clearance)) return true;
    }
    return false;
  };
  Crossing found{};
  found.fits = draw(0, side, placed.starts, found.start);
  if (!draw(kCrossingGoals, -side, *placed.ends, found.goal)) found.fits = found.fits && !travels;
  return found;
}

}  // namespace irsim
