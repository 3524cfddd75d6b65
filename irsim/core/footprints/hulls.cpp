#include "footprints/hulls.hpp"

#include <algorithm>

#include "footprints/manoeuvres.hpp"
#include "geometry/convex_hull.hpp"

namespace irsim {
namespace {

constexpr int kCircleCorners = 12;  // corners of the polygon that stands for a circle of a compound

/// Whether corners go round a convex polygon counter-clockwise, once. Corners of several parts in a row can turn left
/// everywhere and yet go round twice, which is not a polygon.
bool is_convex(const std::vector<Vec2>& points) {
  const std::size_t n = points.size();
  if (n < 3) return false;
  int rounds = 0;  // edges after which the direction leaves the lower half of the plane
  for (std::size_t k = 0; k < n; ++k) {
    const Vec2 along = points[(k + 1) % n] - points[k], next = points[(k + 2) % n] - points[(k + 1) % n];
    if (!(cross(along, next) > 0.0)) return false;
    rounds += along.y < 0.0 && next.y >= 0.0;
  }
  return rounds == 1;
}

constexpr double kSamePoint = 1e-6;  // corners of hulls that are nearer to each other are one [m]

/// Remove corners that are nearly the same as the one before them or as the first.
void merge_corners(std::vector<Vec2>& corners) {
  std::size_t kept = 0;
  for (const Vec2 p : corners) {
    constexpr double kSame2 = kSamePoint * kSamePoint;
    if (kept == 0 || (squared(p - corners[kept - 1]) > kSame2 && squared(p - corners[0]) > kSame2)) corners[kept++] = p;
  }
  corners.resize(kept);
}

}  // namespace

void Hulls::add(const Shapes& shapes, int object, Vec2 position, Vec2 direction) {
  const Slot slot{static_cast<int>(corners_.size()), 0, 0.0};
  slots_.push_back(slot);
  const irsim::Slot& body = shapes.body[object];
  const int parts = shapes.part_count(object);
  const Vec2* vertices = shapes.vertices.data() + body.vertex;
  points_.clear();
  double round = 0.0;
  if (parts == 1 && shapes.parts[body.part].kind == Kind::circle) {
    points_.push_back(vertices[shapes.parts[body.part].first]);
    round = shapes.parts[body.part].radius;
  } else {
    for (int p = 0; p < parts; ++p) {
      const Part& part = shapes.parts[body.part + p];
      if (part.kind != Kind::circle) {
        for (int v = part.first; v < part.last + !is_closed(part.kind); ++v) points_.push_back(vertices[v]);
        continue;
      }
      const double reach = part.radius / std::cos(kPi / kCircleCorners);
      for (int k = 0; k < kCircleCorners; ++k)
        points_.push_back(vertices[part.first] + unit(kTurn * k / kCircleCorners) * reach);
    }
    if (parts == 1 && shapes.parts[body.part].turn < 0.0) std::reverse(points_.begin(), points_.end());
    if (!is_convex(points_)) make_hull(points_, scratch_);
  }
  for (const Vec2 p : points_) corners_.push_back(position + rotate(p, direction));
  close(slot.first, round);
}

void Hulls::add(Vec2 a, Vec2 b) {
  const int first = static_cast<int>(corners_.size());
  slots_.push_back({first, 0, 0.0});
  corners_.push_back(a);
  corners_.push_back(b);
  close(first, 0.0);
}

void Hulls::add(Vec2 centre, double radius) {
  const int first = static_cast<int>(corners_.size());
  slots_.push_back({first, 0, 0.0});
  corners_.push_back(centre);
  close(first, radius);
}

void Hulls::add(const Hull& body, Vec2 position, const Manoeuvre& manoeuvre) {
  const int first = static_cast<int>(corners_.size());
  slots_.push_back({first, 0, 0.0});
  points_.clear();
  for (const Place& place : manoeuvre.places) {
    const Vec2 there = position + place.shift;
    for (int k = 0; k < body.count; ++k) points_.push_back(there + rotate(body.corner[k] - position, place.turn));
  }
  make_hull(points_, scratch_);
  merge_corners(points_);
  corners_.insert(corners_.end(), points_.begin(), points_.end());
  close(first, body.round + manoeuvre.bulge + kSamePoint);
}

void Hulls::close(int first, double round) {
  const int count = static_cast<int>(corners_.size()) - first;
  for (int k = 0; k < count; ++k) {
    const Vec2 along = corners_[first + (k + 1) % count] - corners_[first + k];
    const double length = norm(along);
    normals_.push_back(length > 0.0 ? Vec2{along.y, -along.x} * (1.0 / length) : Vec2{});
  }
  slots_.back() = {first, count, round};
}

Separation separation(const Hull& a, const Hull& b) {
  Separation best{{1.0, 0.0}, -kInfinity};
  for_axes(a, b, [&](Vec2 axis, double gap) {
    if (gap > best.gap) best = {axis, gap};
  });
  return best;
}

}  // namespace irsim
