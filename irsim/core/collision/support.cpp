#include "collision/support.hpp"

namespace irsim {

double support(const Footprint& body, Vec2 direction) {
  double most = -kInfinity;
  for (int p = 0; p < body.count; ++p) {
    const Part& part = body.parts[p];
    if (part.kind == Kind::cells) {  // its vertices are two opposite corners of the box round the cells
      const Vec2 low = body.vertices[part.first], high = body.vertices[part.last];
      const double x = direction.x > 0.0 ? high.x : low.x, y = direction.y > 0.0 ? high.y : low.y;
      most = std::max(most, x * direction.x + y * direction.y);
      continue;
    }
    for (int v = part.first; v <= part.last; ++v) most = std::max(most, dot(body.vertices[v], direction) + part.radius);
  }
  return most;
}

}  // namespace irsim
