#include "footprints/velocity_cones.hpp"

namespace irsim {
namespace {

constexpr double kSmallestGap = 1e-6;  // smallest gap for which bodies have tangents [m]

/// The direction of a tangent to a disc at p, to its left (`side` 1) or right (-1).
Vec2 tangent(Vec2 p, double radius, double side) {
  const double distance2 = squared(p), leg = std::sqrt(std::max(distance2 - radius * radius, 0.0));
  return (p * leg + Vec2{-p.y, p.x} * (side * radius)) * (1.0 / distance2);
}

}  // namespace

Separation cone_of(const Hull& a, const Hull& b, double margin, bool mirrored, std::vector<Face>& faces,
                   VelocityCone& cone) {
  const double sign = mirrored ? -1.0 : 1.0;
  const Hull &one = mirrored ? b : a, &other = mirrored ? a : b;
  Separation apart{{1.0, 0.0}, -kInfinity};
  cone.first = static_cast<int>(faces.size());
  for_axes(one, other, [&](Vec2 axis, double gap) {
    if (gap > apart.gap) apart = {axis * sign, gap};
    if (gap > 0.0) faces.push_back({axis * sign, gap});
  });
  const double kept = std::min(margin, 0.5 * std::max(0.0, apart.gap)), round = a.round + b.round + kept;
  for (std::size_t k = cone.first; k < faces.size(); ++k) faces[k].gap = std::max(faces[k].gap - kept, kSmallestGap);
  cone.left = {apart.axis.y, -apart.axis.x}, cone.right = cone.left * -1.0;  // of bodies that touch: half a plane
  if (apart.gap < kSmallestGap) {
    if (cone.first == static_cast<int>(faces.size())) faces.push_back({apart.axis, kSmallestGap});
    cone.count = static_cast<int>(faces.size()) - cone.first;
    return apart;
  }
  cone.count = static_cast<int>(faces.size()) - cone.first;
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

void cone_of(Vec2 offset, double radius, std::vector<Face>& faces, VelocityCone& cone) {
  const double distance2 = squared(offset), distance = std::sqrt(distance2), rate = 1.0 / distance2;
  const Vec2 along = offset * (std::sqrt(std::max(distance2 - radius * radius, 0.0)) * rate);
  const Vec2 aside = Vec2{-offset.y, offset.x} * (radius * rate);
  cone.left = along + aside, cone.right = along - aside;
  cone.first = static_cast<int>(faces.size()), cone.count = 1;
  faces.push_back({offset * (-1.0 / distance), distance - radius});
}

}  // namespace irsim
