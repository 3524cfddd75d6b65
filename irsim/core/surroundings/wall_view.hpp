// Walls as a disc sees them that wants to get somewhere: how far it can move in a direction, and the tangents of what
// it can pass.
#pragma once

#include <vector>

#include "geometry/vec.hpp"
#include "surroundings/rings.hpp"

namespace irsim {

struct Decision;

/// A wall relative to a disc.
struct Barrier {
  Vec2 a, b, nearest;  // relative to the centre of the disc [m]
  double radius, gap;  // radius of the disc [m]; distance of its rim from the wall [m], negative inside

  Barrier(Vec2 a, Vec2 b, double radius);
  /// Time until the rim reaches the wall at velocity w [s]: 0 if it already does and comes nearer, infinite if never.
  double time(Vec2 w) const;
};

/// The barriers of one ring that face the disc: `first` .. `last` - 1.
struct Front {
  int first = 0, last = 0;
  bool everywhere = true;  // whether they may be met in any direction; else only between the tangents
  HullTangents tangents;
  // of rings that can be passed, else 0
  double look = 0.0;      // directions that meet the ring within this distance are in its way [m]
  double farthest = 0.0;  // distance of the farthest corner of its hull [m]
};

/// Scratch memory.
struct WallView {
  std::vector<Barrier> barriers;
  std::vector<Front> fronts;
  bool passable = false;  // whether a front can be passed

  void clear() { barriers.clear(), fronts.clear(), passable = false; }
  /// Whether velocity w meets a wall within `horizon` [s], or within the part `share` of `look` one that can be passed.
  bool blocks(Vec2 w, double horizon, double share) const;
  /// The first front that can be passed and that direction w, a unit vector, meets within the part `share` of `look`;
  /// null without one.
  const Front* in_the_way(Vec2 w, double share) const;
};

/// Add the walls that an object sees to a view.
///
/// Args:
///   id: The object.
///   position, radius: Its disc, world frame [m].
///   reach: Largest distance of walls from `position` [m].
///   look: Largest distance to walls that can be passed at which they are in the way [m]; 0 if none is to be passed.
///   margin: Added to the radius for the tangents [m].
///   all: Whether `unobstructed` lines count.
void add_walls(const Decision& decision, int id, Vec2 position, double radius, double reach, double look, double margin,
               bool all, WallView& view);

}  // namespace irsim
