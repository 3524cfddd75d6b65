#include "orca/hull_planes.hpp"

namespace irsim {
namespace {

constexpr double kTouching = 1e-6;  // gap below which bodies have no tangents [m]

/// The direction of a tangent to a disc at p, to its left (`side` 1) or right (-1).
Vec2 tangent(Vec2 p, double radius, double side) {
  const double distance2 = squared(p), leg = std::sqrt(std::max(distance2 - radius * radius, 0.0));
  const Vec2 along = p * leg, aside = Vec2{-p.y, p.x} * (side * radius);
  return (along + aside) * (1.0 / distance2);
}

}  // namespace

Separation cone_of(const Hull& a, const Hull& b, double margin, std::vector<Face>& faces, VelocityCone& cone) {
  Separation apart{{1.0, 0.0}, -kInfinity};
  cone.first = static_cast<int>(faces.size());
  for_axes(a, b, [&](Vec2 axis, double gap) {
    if (gap > apart.gap) apart = {axis, gap};
    if (gap > 0.0) faces.push_back({axis, gap});
  });
  cone.count = static_cast<int>(faces.size()) - cone.first;
  const double kept = std::min(margin, 0.5 * std::max(0.0, apart.gap)), round = a.round + b.round + kept;
  for (int k = cone.first; k < cone.first + cone.count; ++k) faces[k].gap = std::max(faces[k].gap - kept, kTouching);
  cone.left = {-apart.axis.y, apart.axis.x}, cone.right = cone.left * -1.0;  // for bodies that touch: half a plane
  cone.left = cone.left * -1.0, cone.right = cone.right * -1.0;
  if (apart.gap < kTouching) {
    if (cone.count == 0) faces.push_back({apart.axis, kTouching}), cone.count = 1;
    return apart;
  }
  Vec2 left = b.corner[0] - a.corner[0], right = left;
  for (int i = 0; i < a.count; ++i) {
    for (int j = 0; j < b.count; ++j) {
      const Vec2 p = b.corner[j] - a.corner[i];
      if (cross(left, p) > 0.0) left = p;
      if (cross(right, p) < 0.0) right = p;
    }
  }
  if (squared(left) <= round * round || squared(right) <= round * round) return apart;
  cone.left = tangent(left, round, 1.0), cone.right = tangent(right, round, -1.0);
  return apart;
}

}  // namespace irsim
