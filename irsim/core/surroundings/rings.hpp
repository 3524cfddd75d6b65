// Rings: closed outlines of static objects, and whether there is a way past them.
//
// An object outside the convex hull of a ring can pass it on either side: every direction between the two tangents of
// the hull meets the ring sooner or later, every other direction misses it. Behaviors that look for a way round walls
// therefore need only the hulls of the rings, however an outline is written: as a rectangle, a polygon, a compound, a
// linestring or the cells of a map. A ring whose hull contains the object, such as the walls of a room, has no tangents
// and is not passable.
#pragma once

#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

/// The object whose outline a ring is.
enum class Inside {
  solid,   // a body
  shell,   // the outer side of a closed line, which is seen only from outside
  hollow,  // the free area of a room
  lining   // the inner side of a closed line or of a hole in a compound, which is seen only from within
};

/// HullTangents of a hull, widened by the radius of a disc, from the centre of the disc. Unit vectors.
struct HullTangents {
  Vec2 left, right;
  Vec2 left_corner, right_corner;  // corners of the hull that they touch, relative to the disc [m]

  /// Whether direction `w` leads between the tangents, by more than `margin` for a unit vector.
  bool hold(Vec2 w, double margin = 0.0) const { return cross(left, w) <= -margin && cross(right, w) >= margin; }
};

/// A closed outline, world frame.
struct Ring {
  int object;
  Inside inside;
  std::vector<Vec2> hull;     // counter-clockwise; the two ends of a ring without area
  std::vector<Vec2> corners;  // of a shell or a lining, the first one again at the end; else empty

  int first = 0, last = 0;  // its walls: `first` .. `last` - 1 of Walls::list

  Ring(const std::vector<Vec2>& outline, Inside inside, int object);
  /// Whether its box meets another one.
  bool meets(const Box& box) const { return box_.meets(box); }
  /// Distance of `p` from the hull [m]; 0 inside.
  double distance(Vec2 p) const;
  bool can_be_passed() const { return inside == Inside::solid || inside == Inside::shell; }
  /// Whether an object at `p` can see the walls of this ring.
  bool is_seen_from(Vec2 p) const;
  /// The tangents for a disc at `p`, at `distance` > 0 from the hull. A disc that is nearer than its radius counts as
  /// one that touches the hull.
  HullTangents tangents(Vec2 p, double distance, double radius) const;
  /// Distance of the farthest corner of the hull from `p` [m].
  double farthest(Vec2 p) const;

 private:
  Box box_;
};

/// The corners of an outline, without corners that do not bend it or that repeat the one before.
std::vector<Vec2> bends_of(const Vec2* corners, int count);

}  // namespace irsim
