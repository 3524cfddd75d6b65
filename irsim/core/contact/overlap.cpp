#include "contact/overlap.hpp"

#include "geometry/predicates.hpp"

namespace irsim {
namespace {

constexpr double kFlat = 1e-7;  // corners within this distance of the outermost one belong to the same face [m]

Overlap discs(const Placed& a, const Placed& b) {
  const Vec2 between = *a.vertices - *b.vertices;
  const double distance = norm(between);
  const Vec2 normal = distance > 0.0 ? between * (1.0 / distance) : Vec2{1.0, 0.0};
  const double depth = a.radius + b.radius - distance;
  return {normal, depth, *b.vertices + normal * (b.radius - 0.5 * depth)};
}

/// Overlap of the disc `a` with the polygon or segment `b`.
Overlap disc_and(const Placed& a, const Placed& b, double gap) {
  const Vec2 centre = *a.vertices;
  double signed_distance = -kInfinity;  // of the centre, from the face with the largest distance
  int face = 0;
  for (int k = 0; k < b.count; ++k) {
    const double d = dot(b.normals[k], centre - b.vertices[k]);
    if (d > signed_distance) signed_distance = d, face = k;
  }
  if (signed_distance - a.radius > gap) return {};
  Vec2 normal = b.normals[face];
  const Vec2 from = b.vertices[face], to = b.vertices[face + 1 < b.count ? face + 1 : 0];
  double distance = signed_distance;
  if (signed_distance >= 0.0) {
    const double along = dot(centre - from, to - from);
    const double length2 = squared(to - from);
    if (along < 0.0 || along > length2) {  // a corner is nearest
      const Vec2 away = centre - (along < 0.0 ? from : to);
      distance = norm(away);
      if (distance - a.radius > gap) return {};
      if (distance > 0.0) normal = away * (1.0 / distance);
    }
  }
  const double depth = a.radius - distance;
  return {normal, depth, centre - normal * (a.radius - 0.5 * depth)};
}

/// Find the face of `of` from which `other` has the largest signed distance, and return that distance [m].
double best_face(const Placed& of, const Placed& other, int& face) {
  double best = -kInfinity;
  for (int k = 0; k < of.count; ++k) {
    double lowest = kInfinity;
    for (int j = 0; j < other.count; ++j) {
      lowest = std::min(lowest, dot(of.normals[k], other.vertices[j] - of.vertices[k]));
    }
    if (lowest > best) best = lowest, face = k;
  }
  return best;
}

/// The extent along `tangent` of those corners of a piece that are outermost along `direction`.
struct Face {
  double low = kInfinity, high = -kInfinity, out = -kInfinity;
};
Face outermost(const Placed& piece, Vec2 direction, Vec2 tangent) {
  Face face;
  for (int k = 0; k < piece.count; ++k) face.out = std::max(face.out, dot(direction, piece.vertices[k]));
  for (int k = 0; k < piece.count; ++k) {
    if (dot(direction, piece.vertices[k]) < face.out - kFlat) continue;
    const double t = dot(tangent, piece.vertices[k]);
    face.low = std::min(face.low, t);
    face.high = std::max(face.high, t);
  }
  return face;
}

Overlap polygons(const Placed& a, const Placed& b, double gap) {
  int face_a = 0, face_b = 0;
  const double apart_a = best_face(a, b, face_a);
  if (apart_a > gap) return {};
  const double apart_b = best_face(b, a, face_b);
  if (apart_b > gap) return {};
  const Vec2 normal = apart_a >= apart_b ? a.normals[face_a] * -1.0 : b.normals[face_b];
  const double depth = -std::max(apart_a, apart_b);
  const Vec2 tangent{-normal.y, normal.x};
  const Face fa = outermost(a, normal * -1.0, tangent), fb = outermost(b, normal, tangent);
  const double low = std::max(fa.low, fb.low), high = std::min(fa.high, fb.high);
  return {normal, depth, normal * (0.5 * (fb.out - fa.out)) + tangent * (0.5 * (low + high))};
}

}  // namespace

Overlap overlap_of(const Placed& a, const Placed& b, double gap) {
  if (a.count == 1) {
    if (b.count != 1) return disc_and(a, b, gap);
    const Overlap both = discs(a, b);
    return -both.depth > gap ? Overlap{} : both;
  }
  if (b.count != 1) return polygons(a, b, gap);
  Overlap turned = disc_and(b, a, gap);
  turned.normal = turned.normal * -1.0;
  return turned;
}

}  // namespace irsim
