#include "geometry/sector.hpp"

#include "geometry/predicates.hpp"

namespace irsim {
namespace {

/// A sector about the origin whose axis is +x.
struct Wedge {
  Vec2 edge;  // unit direction of the upper end
  bool whole, wide;
  double reach;

  explicit Wedge(const Sector& s)
      : edge(unit(s.half)), whole(s.half >= kPi), wide(s.half > 0.5 * kPi), reach(s.reach) {}

  /// Signed distances from the lines through both edges, positive on the side of the sector.
  double upper(Vec2 p) const { return cross(p, edge); }
  double lower(Vec2 p) const { return edge.x * p.y + edge.y * p.x; }
  bool between_edges(Vec2 p) const {
    if (whole) return true;
    const bool above = lower(p) >= 0.0, below = upper(p) >= 0.0;
    return wide ? above || below : above && below && p.x >= 0.0;
  }
};

bool disc_meets(const Wedge& wedge, Vec2 centre, double radius) {
  const double distance = norm(centre);
  if (wedge.between_edges(centre)) return distance - wedge.reach <= radius;
  for (const Vec2 edge : {wedge.edge, Vec2{wedge.edge.x, -wedge.edge.y}}) {
    if (squared(nearest_on_segment({}, edge * wedge.reach, centre) - centre) <= radius * radius) return true;
  }
  return false;
}

/// Narrow [low, high] to the t at which the linear function `side` of a + t (b - a) is not negative. Returns false if
/// none remains.
template <class Side>
bool keep(Side&& side, Vec2 a, Vec2 b, double& low, double& high) {
  const double at_a = side(a), at_b = side(b), change = at_b - at_a;
  if (change == 0.0) return at_a >= 0.0;
  const double t = -at_a / change;
  change > 0.0 ? low = std::max(low, t) : high = std::min(high, t);
  return low <= high;
}

bool segment_meets(const Wedge& wedge, Vec2 a, Vec2 b) {
  // within reach: |a + t along|^2 <= reach^2
  const Vec2 along = b - a;
  const double aa = squared(along), ab = dot(a, along), c = squared(a) - wedge.reach * wedge.reach;
  double low = 0.0, high = 1.0;
  if (aa > 0.0) {
    const double root2 = ab * ab - aa * c;
    if (!(root2 >= 0.0)) return false;
    const double root = std::sqrt(root2);
    low = std::max(low, (-ab - root) / aa), high = std::min(high, (-ab + root) / aa);
    if (!(low <= high)) return false;
  } else if (!(c <= 0.0)) {
    return false;
  }
  if (wedge.whole) return true;
  if (wedge.wide) return wedge.between_edges(a + along * low) || wedge.between_edges(a + along * high);
  return keep([&](Vec2 p) { return wedge.upper(p); }, a, b, low, high) &&
         keep([&](Vec2 p) { return wedge.lower(p); }, a, b, low, high) &&
         keep([](Vec2 p) { return p.x; }, a, b, low, high);
}

}  // namespace

bool meets(const OccupancyGrid& grid, const Sector& sector) {
  const Wedge wedge(sector);
  const Vec2 axis = unit(sector.middle);
  return grid.any_in(box_around(sector.apex, sector.reach), [&](int i, int j) {
    const Box box = grid.box(i, j);
    if (box.meets(box_around(sector.apex, 0.0))) return true;
    Vec2 corners[5] = {{box.x0, box.y0}, {box.x1, box.y0}, {box.x1, box.y1}, {box.x0, box.y1}};
    for (int k = 0; k < 4; ++k) corners[k] = unrotate(corners[k] - sector.apex, axis);
    corners[4] = corners[0];
    for (int k = 0; k < 4; ++k) {
      if (segment_meets(wedge, corners[k], corners[k + 1])) return true;
    }
    return false;
  });
}

bool meets(const Footprint& body, const Sector& sector) {
  const bool near = norm(body.centre - sector.apex) <= (sector.reach + body.radius) * (1.0 + 1e-9) + 1e-9;
  if (!near && body.parts[0].kind != Kind::room) return false;
  const Wedge wedge(sector);
  const Vec2 axis = unit(sector.middle);
  const auto local = [&](Vec2 p) { return unrotate(p - sector.apex, axis); };
  for (int k = 0; k < body.count; ++k) {
    const Part& part = body.parts[k];
    const Vec2* vertices = body.vertices + part.first;
    if (part.kind == Kind::circle) {
      if (disc_meets(wedge, local(*vertices), part.radius)) return true;
      continue;
    }
    if (part.cells != nullptr) {
      if (meets(*part.cells, sector)) return true;
      continue;
    }
    const int edges = part.last - part.first;
    if (part.kind == Kind::room && !inside_ring(vertices, edges, sector.apex)) return true;
    if (part.kind == Kind::polygon && inside_ring(vertices, edges, sector.apex)) return true;
    for (int i = 0; i < edges; ++i) {
      if (segment_meets(wedge, local(vertices[i]), local(vertices[i + 1]))) return true;
    }
  }
  return false;
}

}  // namespace irsim
