// When two footprints that move during a step first touch.
#pragma once

#include <vector>

#include "collision/stride.hpp"
#include "geometry/shapes.hpp"

namespace irsim {

/// A footprint that moves: its parts with vertices in the frame of `stride`.
struct Moving {
  const Part* parts;
  int count;
  const Vec2* vertices;
  Vec2 centre;    // of the bounding circle
  double radius;  // of the bounding circle [m]
  Stride stride;
};

/// The body of an object that makes a stride.
inline Moving moving_body(const Shapes& shapes, int object, const Stride& stride) {
  return {shapes.parts.data() + shapes.body[object].part,
          shapes.part_count(object),
          shapes.vertices.data() + shapes.body[object].vertex,
          shapes.centre[object],
          shapes.radius[object],
          stride};
}
/// A footprint that rests where it is.
inline Moving resting_body(const Footprint& body) {
  return {body.parts, body.count, body.vertices, body.centre, body.radius, Stride{}};
}

/// A convex piece of the boundary of a part: a disc (one vertex and a radius), a segment or a convex polygon.
struct SweptFace {
  int first, count;  // vertices in `SweptBuffers::points`
  double radius;
  double arm;  // largest distance of a vertex from the origin of the body [m]
  Box box;     // of its motion
};

/// Scratch memory.
struct SweptBuffers {
  std::vector<Vec2> points, a, b;
  std::vector<SweptFace> faces_a, faces_b;
};

/// The first time in [begin, end] at which two bodies that are apart at `begin` touch, within about 1e-9 m; infinite if
/// they do not. `where` becomes the place. Bodies that overlap at `begin` may be reported or not.
///
/// Conservative advancement (Mirtich 1996): the line between the nearest points of two convex pieces separates them
/// until, at the soonest, bounds of the motions of their vertices along it meet. The search goes on from there.
double first_contact(const Moving& a, const Moving& b, double begin, double end, SweptBuffers& buffers, Vec2& where);

}  // namespace irsim
