#include "sensing/crossings.hpp"

#include "geometry/predicates.hpp"
#include "maps/walk.hpp"

namespace irsim {
namespace {

/// Number of edges between two points. A corner that the line passes belongs to one of its two edges.
int edges_crossed(const Vec2* vertices, int edges, Vec2 from, Vec2 to) {
  int count = 0;
  bool left = turn_of(from, to, vertices[0]) > 0.0;
  for (int k = 0; k < edges; ++k) {
    const bool was_left = left;
    left = turn_of(from, to, vertices[k + 1]) > 0.0;
    if (left == was_left) continue;
    const Vec2 a = vertices[k], b = vertices[k + 1];
    if ((turn_of(a, b, from) > 0.0) != (turn_of(a, b, to) > 0.0)) ++count;
  }
  return count;
}

int areas_crossed(const OccupancyGrid& grid, Vec2 from, Vec2 to) {
  const double length = norm(to - from);
  if (!(length > 0.0)) return 0;
  const Vec2 beam = (to - from) * (1.0 / length);
  const CellWalk walk(grid, from);
  const auto solid = [&](double at) {
    const Vec2 p = from + beam * at - grid.origin();
    const double column = p.x / grid.cell().x, row = p.y / grid.cell().y;
    if (!(column >= 0.0 && column < grid.columns() && row >= 0.0 && row < grid.rows())) return false;
    return grid.occupied(static_cast<int>(column), static_cast<int>(row));
  };
  int count = 0;
  bool inside = false;
  for (double at = 0.0; at < length;) {
    const double next = std::min(length, walk.hit(beam, at, length));
    const bool now = solid(0.5 * (at + next));
    count += now && !inside;
    inside = now, at = next;
  }
  return count;
}

}  // namespace

int crossings(const Footprint& body, Vec2 from, Vec2 to) {
  int count = 0;
  for (int k = 0; k < body.count; ++k) {
    const Part& part = body.parts[k];
    const Vec2* vertices = body.vertices + part.first;
    const int edges = part.last - part.first;
    if (part.cells != nullptr) {
      count += areas_crossed(*part.cells, from, to);
    } else if (part.kind == Kind::circle) {
      count += squared(nearest_on_segment(from, to, *vertices) - *vertices) < part.radius * part.radius;
    } else if (is_closed(part.kind)) {
      const bool solid_inside = part.kind == Kind::polygon;
      const bool starts = inside_ring(vertices, edges, from) == solid_inside;
      const bool ends = inside_ring(vertices, edges, to) == solid_inside;
      count += (edges_crossed(vertices, edges, from, to) + starts + ends) / 2;
    } else {
      count += edges_crossed(vertices, edges, from, to);
    }
  }
  return count;
}

}  // namespace irsim
