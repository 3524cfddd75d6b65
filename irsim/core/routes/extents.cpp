#include "routes/extents.hpp"

#include "geometry/predicates.hpp"

namespace irsim {

Extent extent_of(const Shapes& shapes, int object) {
  Extent extent;
  const Slot& slot = shapes.body[object];
  for (int p = 0; p < shapes.part_count(object); ++p) {
    const Part& part = shapes.parts[slot.part + p];
    for (int v = part.first; v <= part.last; ++v) {
      const Vec2 vertex = shapes.vertices[slot.vertex + v];
      extent.reach = std::max(extent.reach, norm(vertex) + part.radius);
      extent.side = std::max(extent.side, std::fabs(vertex.y) + part.radius);
    }
  }
  return extent;
}

double inner_radius(const Shapes& shapes, int object) {
  double radius = 0.0;
  const Slot& slot = shapes.body[object];
  for (int p = 0; p < shapes.part_count(object); ++p) {
    const Part& part = shapes.parts[slot.part + p];
    const Vec2* vertices = &shapes.vertices[slot.vertex];
    if (part.kind == Kind::circle) {
      radius = std::max(radius, part.radius - norm(vertices[part.first]));
      continue;
    }
    double within = part.kind == Kind::polygon ? kInfinity : 0.0;
    for (int v = part.first; v < part.last && within > 0.0; ++v) {
      const Vec2 a = vertices[v], b = vertices[v + 1];
      within = std::min(within, part.turn * cross(b - a, a * -1.0) > 0.0 ? norm(nearest_on_segment(a, b, {})) : 0.0);
    }
    radius = std::max(radius, within);
  }
  return radius;
}

double sweeping_reach(const Shapes& shapes, int object) {
  const double reach = extent_of(shapes, object).reach;
  return inner_radius(shapes, object) < reach ? reach : 0.0;
}

}  // namespace irsim
