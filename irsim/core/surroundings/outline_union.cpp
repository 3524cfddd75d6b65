#include "surroundings/outline_union.hpp"

#include <algorithm>

#include "geometry/predicates.hpp"

namespace irsim {
namespace {

constexpr double kMeets = 1e-9;       // points and edges this close meet [m]
constexpr double kSameCorner = 1e-7;  // ends of pieces this close are one corner [m]

using RingCorners = std::vector<Vec2>;

struct Piece {
  Vec2 a, b;
  bool used = false;
};

enum class Place { outside, inside, same_edge, opposite_edge };

/// Where the middle of a piece with this direction is relative to a polygon.
Place place_of(Vec2 middle, Vec2 direction, const RingCorners& polygon) {
  RingCorners closed = polygon;
  closed.push_back(polygon.front());
  for (std::size_t k = 0; k + 1 < closed.size(); ++k) {
    if (norm(nearest_on_segment(closed[k], closed[k + 1], middle) - middle) > kMeets) continue;
    return dot(closed[k + 1] - closed[k], direction) > 0.0 ? Place::same_edge : Place::opposite_edge;
  }
  const bool inside = inside_ring(closed.data(), static_cast<int>(polygon.size()), middle);
  return inside ? Place::inside : Place::outside;
}

/// Add the distances from `a` at which a polygon meets the edge from `a` to `b`.
void cut(Vec2 a, Vec2 b, const RingCorners& polygon, std::vector<double>& cuts) {
  const Vec2 along = (b - a) * (1.0 / norm(b - a));
  const double length = norm(b - a);
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2 c = polygon[k], d = polygon[(k + 1) % polygon.size()];
    const double off_c = cross(along, c - a), off_d = cross(along, d - a);
    if (std::fabs(off_c) <= kMeets) cuts.push_back(dot(along, c - a));
    if (std::fabs(off_c) <= kMeets || std::fabs(off_d) <= kMeets || (off_c > 0.0) == (off_d > 0.0)) continue;
    cuts.push_back(dot(along, c + (d - c) * (off_c / (off_c - off_d)) - a));
  }
  for (double& at : cuts) at = clip(at, 0.0, length);
}

/// The pieces of the edges of polygon `self` that are on the outline of the union.
void add_pieces(const std::vector<RingCorners>& polygons, std::size_t self, std::vector<Piece>& pieces) {
  const RingCorners& ring = polygons[self];
  std::vector<double> cuts;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 a = ring[k], b = ring[(k + 1) % ring.size()];
    const double length = norm(b - a);
    if (length <= kMeets) continue;
    const Vec2 along = (b - a) * (1.0 / length);
    cuts.assign({0.0, length});
    for (std::size_t other = 0; other < polygons.size(); ++other)
      if (other != self) cut(a, b, polygons[other], cuts);
    std::sort(cuts.begin(), cuts.end());
    double from = 0.0;
    for (const double to : cuts) {
      if (to - from <= kMeets) continue;
      const Vec2 middle = a + along * (0.5 * (from + to));
      bool kept = true;
      for (std::size_t other = 0; other < polygons.size() && kept; ++other) {
        if (other == self) continue;
        const Place place = place_of(middle, along, polygons[other]);
        kept = place == Place::outside || (place == Place::same_edge && self < other);
      }
      if (kept) pieces.push_back({from > 0.0 ? a + along * from : a, to < length ? a + along * to : b});
      from = to;
    }
  }
}

/// The unused piece that starts at the end of `last` and turns farthest to the left there, so that bodies which touch
/// in one corner keep rings of their own; null without one.
Piece* next_piece(std::vector<Piece>& pieces, const Piece& last) {
  Piece* best = nullptr;
  double most = -kInfinity;
  for (Piece& piece : pieces) {
    if (piece.used || norm(piece.a - last.b) > kSameCorner) continue;
    const Vec2 in = last.b - last.a, out = piece.b - piece.a;
    const double turn = std::atan2(cross(in, out), dot(in, out));
    if (turn > most) most = turn, best = &piece;
  }
  return best;
}

}  // namespace

std::vector<std::vector<Vec2>> union_of(const std::vector<std::vector<Vec2>>& polygons) {
  std::vector<Piece> pieces;
  for (std::size_t k = 0; k < polygons.size(); ++k) add_pieces(polygons, k, pieces);
  std::vector<RingCorners> rings;
  for (Piece& first : pieces) {
    if (first.used) continue;
    first.used = true;
    RingCorners ring{first.a};
    for (const Piece* last = &first; norm(last->b - first.a) > kSameCorner;) {
      Piece* next = next_piece(pieces, *last);
      if (next == nullptr) return polygons;
      next->used = true;
      ring.push_back(next->a);
      last = next;
    }
    rings.push_back(std::move(ring));
  }
  return rings;
}

}  // namespace irsim
