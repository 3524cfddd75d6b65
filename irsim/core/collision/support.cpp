#include "collision/support.hpp"

namespace irsim {

double support(const Footprint& body, Vec2 direction) {
  double most = -kInfinity;
  for (int p = 0; p < body.count; ++p) {
    const Part& part = body.parts[p];
    for (int v = part.first; v <= part.last; ++v) most = std::max(most, dot(body.vertices[v], direction) + part.radius);
  }
  return most;
}

}  // namespace irsim
