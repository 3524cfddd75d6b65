// Convex hulls of footprints, and how far two of them are apart.
#pragma once

#include <vector>

#include "geometry/shapes.hpp"

namespace irsim {

struct Manoeuvre;

/// A convex polygon with rounded corners, world frame: all points within `round` [m] of the polygon. One corner makes a
/// disc, two make a capsule. Edge k leads from corner k to the next one, counter-clockwise.
struct Hull {
  const Vec2* corner;
  const Vec2* normal;  // outward unit normals of the edges; none for a disc
  int count;
  double round;

  /// Smallest dot product of `axis` with a point of the polygon, without its rounding [m].
  double least(Vec2 axis) const {
    double value = dot(axis, corner[0]);
    for (int k = 1; k < count; ++k) value = std::min(value, dot(axis, corner[k]));
    return value;
  }
  int edges() const { return count == 1 ? 0 : count; }
};

/// Hulls of many bodies.
class Hulls {
 public:
  void clear() { slots_.clear(), corners_.clear(), normals_.clear(); }
  /// Add the hull of an object of `shapes` at a pose.
  void add(const Shapes& shapes, int object, Vec2 position, Vec2 direction);
  /// Add the segment from a to b.
  void add(Vec2 a, Vec2 b);
  /// Add a disc.
  void add(Vec2 centre, double radius);
  /// Add the hull of all places of a body that is at `position`.
  void add(const Hull& body, Vec2 position, const Manoeuvre& manoeuvre);
  int count() const { return static_cast<int>(slots_.size()); }
  Hull operator[](int k) const {
    const Slot& s = slots_[k];
    return {&corners_[s.first], &normals_[s.first], s.count, s.round};
  }

 private:
  struct Slot {
    int first, count;
    double round;
  };
  void close(int first, double round);

  std::vector<Slot> slots_;
  std::vector<Vec2> corners_, normals_, points_, scratch_;
};

/// How two hulls are apart.
struct Separation {
  Vec2 axis;   // unit vector from b to a along which the gap is largest
  double gap;  // [m]; negative if they overlap
};

/// Call `visit(axis, gap)` for each line that may separate hull a from hull b: the edges of both, and for rounded ones
/// the line between their nearest corners. The largest gap is their distance, or less if corners face each other.
template <class Visit>
void for_axes(const Hull& a, const Hull& b, Visit&& visit) {
  const double round = a.round + b.round;
  for (int k = 0; k < b.edges(); ++k) visit(b.normal[k], a.least(b.normal[k]) - dot(b.normal[k], b.corner[k]) - round);
  for (int k = 0; k < a.edges(); ++k) {
    visit(a.normal[k] * -1.0, b.least(a.normal[k]) - dot(a.normal[k], a.corner[k]) - round);
  }
  if (!(round > 0.0)) return;
  double least = kInfinity;
  Vec2 between;
  for (int i = 0; i < a.count; ++i) {
    for (int j = 0; j < b.count; ++j) {
      const Vec2 offset = a.corner[i] - b.corner[j];
      if (squared(offset) < least) least = squared(offset), between = offset;
    }
  }
  if (!(least > 0.0)) return;
  const Vec2 axis = between * (1.0 / std::sqrt(least));
  visit(axis, a.least(axis) + b.least(axis * -1.0) - round);
}

Separation separation(const Hull& a, const Hull& b);

/// The same, computed as if the bodies were swapped: both bodies find the same axis to
/// the last bit.
inline Separation mirrored_separation(const Hull& a, const Hull& b) {
  const Separation apart = separation(b, a);
  return {apart.axis * -1.0, apart.gap};
}

}  // namespace irsim
