// The footprint for which a path is planned. It keeps its heading and moves along straight lines.
#pragma once

#include <vector>

#include "geometry/shapes.hpp"

namespace irsim {

/// Parts of one rigid body about its origin, which can be placed anywhere. The footprints returned are scratch memory
/// of the body until the next call, so only one thread may use a body at a time.
class Body {
 public:
  static Body disc(double radius);
  /// A box about the origin.
  static Body box(double half_x, double half_y);
  /// The parts of an object at a heading, enlarged by `margin` [m] on all sides.
  static Body of(const Shapes& shapes, int object, double heading, double margin);

  /// The footprint at a point.
  const Footprint& at(Vec2 p);
  /// The area that the body covers on the way from a to b beyond its footprint at a.
  const Footprint& swept(Vec2 a, Vec2 b);
  /// Distance of its farthest point from its origin [m].
  double reach() const { return reach_; }
  /// The box around the footprint at the origin.
  const Box& box() const { return box_; }
  /// Call a function with everything but the scratch memory.
  template <class Visit>
  void visit(Visit&& visit) {
    visit(parts_, vertices_, part_boxes_, box_, reach_);
  }

 private:
  struct Placed {
    std::vector<Part> parts;
    std::vector<Vec2> vertices;
    std::vector<Box> boxes;
    Footprint footprint;
    void clear();
    void add_circle(Vec2 centre, double radius);
    void add_ring(const Vec2* corners, int count, Kind kind, double turn);
    const Footprint& done();
  };

  void add_circle(Vec2 centre, double radius);
  void add_outline(Kind kind, std::vector<Vec2> vertices, double turn);
  void finish();

  std::vector<Part> parts_;
  std::vector<Vec2> vertices_;
  std::vector<Box> part_boxes_;
  Box box_;
  double reach_ = 0.0;
  Placed there_, way_;
};

}  // namespace irsim
