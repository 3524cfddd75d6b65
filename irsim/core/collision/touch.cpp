#include "collision/touch.hpp"

#include "geometry/predicates.hpp"

namespace irsim {
namespace {

/// A part with its world-frame vertices and box.
struct Shape {
  const Part& part;
  const Vec2* vertices;
  const Box& box;

  const Vec2* begin() const { return vertices + part.first; }
  int edges() const { return part.last - part.first; }
  bool filled() const { return part.kind == Kind::polygon; }
};

Box edge_box(const Vec2* edge) {
  return {std::min(edge[0].x, edge[1].x), std::min(edge[0].y, edge[1].y), std::max(edge[0].x, edge[1].x),
          std::max(edge[0].y, edge[1].y)};
}

bool contains(const Shape& piece, Vec2 p) { return piece.filled() && inside_ring(piece.begin(), piece.edges(), p); }

bool circles_touch(const Shape& a, const Shape& b, Vec2& where) {
  const Vec2 ca = *a.begin(), d = *b.begin() - ca;
  const double reach = a.part.radius + b.part.radius, distance2 = squared(d);
  if (!(distance2 <= reach * reach)) return false;
  const double distance = std::sqrt(distance2);
  // the point in the middle of the overlap on the line of centres
  const double low = std::max(-a.part.radius, distance - b.part.radius);
  const double high = std::min(a.part.radius, distance + b.part.radius);
  where = distance > 0.0 ? ca + d * (0.5 * (low + high) / distance) : ca;
  return true;
}

bool circle_touches(const Shape& circle, const Shape& other, Vec2& where) {
  const Vec2 centre = *circle.begin();
  const double radius2 = circle.part.radius * circle.part.radius;
  for (int i = 0; i < other.edges(); ++i) {
    const Vec2* edge = other.begin() + i;
    if (!edge_box(edge).meets(circle.box)) continue;
    const Vec2 nearest = nearest_on_segment(edge[0], edge[1], centre);
    if (squared(nearest - centre) <= radius2) return where = nearest, true;
  }
  if (contains(other, centre)) return where = centre, true;
  return false;
}

bool edges_touch(const Shape& a, const Shape& b, Vec2& where) {
  for (int i = 0; i < a.edges(); ++i) {
    const Vec2* p = a.begin() + i;
    const Box p_box = edge_box(p);
    if (!p_box.meets(b.box)) continue;
    for (int j = 0; j < b.edges(); ++j) {
      const Vec2* q = b.begin() + j;
      if (p_box.meets(edge_box(q)) && segments_meet(p[0], p[1], q[0], q[1], where)) return true;
    }
  }
  if (contains(a, *b.begin())) return where = *b.begin(), true;
  if (contains(b, *a.begin())) return where = *a.begin(), true;
  return false;
}

bool cells_touch(const OccupancyGrid& grid, const Shape& other, Vec2& where) {
  if (other.part.kind == Kind::circle) return disc_meets(grid, *other.begin(), other.part.radius, where);
  if (other.part.kind == Kind::cells) return false;
  return outline_meets(grid, other.begin(), other.edges(), other.filled(), other.box, where);
}

bool pieces_touch(const Shape& a, const Shape& b, Vec2& where) {
  if (a.part.cells != nullptr) return cells_touch(*a.part.cells, b, where);
  if (b.part.cells != nullptr) return cells_touch(*b.part.cells, a, where);
  const bool a_round = a.part.kind == Kind::circle, b_round = b.part.kind == Kind::circle;
  if (a_round) return b_round ? circles_touch(a, b, where) : circle_touches(a, b, where);
  return b_round ? circle_touches(b, a, where) : edges_touch(a, b, where);
}

}  // namespace

bool touch(const Footprint& a, const Footprint& b, Vec2& where) {
  for (int i = 0; i < a.count; ++i) {
    if (!a.part_boxes[i].meets(b.box)) continue;
    for (int j = 0; j < b.count; ++j) {
      if (!a.part_boxes[i].meets(b.part_boxes[j])) continue;
      if (pieces_touch({a.parts[i], a.vertices, a.part_boxes[i]}, {b.parts[j], b.vertices, b.part_boxes[j]}, where)) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace irsim
