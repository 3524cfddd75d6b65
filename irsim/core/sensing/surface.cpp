#include "sensing/surface.hpp"

#include "geometry/predicates.hpp"
#include "maps/occupancy.hpp"

namespace irsim {
namespace {

constexpr double kOnEdge = 1e-9;  // offset of a hit from the edge that it is on, relative to the coordinates
constexpr double kStair = 4.0;    // cells between the hits of neighboring beams that are taken for one wall

double slack(Vec2 at) { return kOnEdge * (1.0 + std::fabs(at.x) + std::fabs(at.y)); }

Vec2 normal_to(Vec2 along) {
  const double length = norm(along);
  return length > 0.0 ? Vec2{along.y, -along.x} * (1.0 / length) : Vec2{1.0, 0.0};
}

}  // namespace

Vec2 Surface::normal(const Fan& fan, int i) {
  const int object = fan.hit(i);
  const Vec2 at = fan.end(i);
  if (object == object_) {
    const double way = dot(at - from_, along_);
    if (std::fabs(dot(at - from_, normal_)) <= slack(at) && way >= 0.0 && way <= squared(along_)) return normal_;
  }
  const Footprint body = sensing_.footprint(object);
  object_ = -1;
  const double near = slack(at) * slack(at);
  double least = kInfinity;
  Vec2 out{1.0, 0.0};
  const auto take = [&](Vec2 from, Vec2 along) { object_ = object, from_ = from, along_ = along; };
  for (int part = 0; part < body.count; ++part) {
    const Part& p = body.parts[part];
    const Vec2* vertices = body.vertices + p.first;
    if (p.cells != nullptr) return object_ = -1, normal_of_cells(*p.cells, fan, i);
    if (p.kind == Kind::circle) {
      const Vec2 arm = at - *vertices;
      const double length = norm(arm), away = (length - p.radius) * (length - p.radius);
      if (away < least) least = away, object_ = -1, out = length > 0.0 ? arm * (1.0 / length) : out;
    }
    for (int k = 0; k < p.last - p.first; ++k) {
      const Vec2 along = vertices[k + 1] - vertices[k], rest = at - vertices[k];
      const double aside = cross(rest, along), way = dot(rest, along), length2 = squared(along);
      if (aside * aside <= near * length2 && way >= 0.0 && way <= length2) {
        take(vertices[k], along);
        return normal_ = normal_to(along);
      }
    }
    for (int k = 0; k < p.last - p.first; ++k) {  // the hit is off all edges, which happens beside corners
      const double away = squared(at - nearest_on_segment(vertices[k], vertices[k + 1], at));
      if (away < least) least = away, take(vertices[k], vertices[k + 1] - vertices[k]);
    }
  }
  return object_ < 0 ? out : normal_ = normal_to(along_);
}

Vec2 Surface::normal_of_cells(const OccupancyGrid& grid, const Fan& fan, int i) const {
  const Vec2 at = fan.end(i), cell = grid.cell();
  const double near = kStair * std::max(cell.x, cell.y);
  const auto same_wall = [&](int k) {
    return k >= 0 && k < fan.count() && fan.hit(k) == fan.hit(i) && norm(fan.end(k) - at) <= near;
  };
  const int low = same_wall(i - 1) ? i - 1 : i, high = same_wall(i + 1) ? i + 1 : i;
  if (low != high) return normal_to(fan.end(high) - fan.end(low));
  const auto off_line = [](double place, double origin, double size) {
    const double cells = (place - origin) / size;
    return std::fabs(cells - std::floor(cells + 0.5)) * size;
  };
  const bool upright = off_line(at.x, grid.origin().x, cell.x) < off_line(at.y, grid.origin().y, cell.y);
  return upright ? Vec2{1.0, 0.0} : Vec2{0.0, 1.0};
}

}  // namespace irsim
