#include "routes/sides.hpp"

namespace irsim {
namespace {

/// Call `visit(vertex, next)` for each vertex of a footprint and the next one of its part.
template <class Visit>
void for_vertices(const Footprint& body, Visit&& visit) {
  for (int p = 0; p < body.count; ++p) {
    const Part& part = body.parts[p];
    for (int v = part.first; v <= part.last; ++v)
      visit(body.vertices[v], body.vertices[v < part.last ? v + 1 : part.first]);
  }
}

}  // namespace

double widest_strip(const Footprint& a, const Footprint& b, Vec2& normal) {
  double widest = -kInfinity;
  const auto offer = [&](Vec2 across) {
    const double length = norm(across);
    if (!(length > 0.0)) return;
    const Vec2 n = across * (1.0 / length);
    const double width = -support(b, n * -1.0) - support(a, n);
    if (width > widest) widest = width, normal = n;
  };
  // The strip is across an edge of one of them, or across the line between two vertices.
  for_vertices(a, [&](Vec2 p, Vec2 q) {
    offer({q.y - p.y, p.x - q.x});
    offer({p.y - q.y, q.x - p.x});
    for_vertices(b, [&](Vec2 r, Vec2) { offer(r - p); });
  });
  for_vertices(b, [&](Vec2 p, Vec2 q) {
    offer({q.y - p.y, p.x - q.x});
    offer({p.y - q.y, q.x - p.x});
  });
  return widest;
}

}  // namespace irsim
