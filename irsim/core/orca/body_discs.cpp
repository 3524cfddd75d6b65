#include "orca/body_discs.hpp"

namespace irsim {
namespace {

constexpr double kLong = 1.3;        // ratio of the sides of the box round a body from which it is long
constexpr double kDiscsPerSide = 2;  // discs for each length of the short side

}  // namespace

BodyDiscs body_discs(const Shapes& shapes, int object) {
  Box box;
  const Slot& slot = shapes.body[object];
  for (int p = 0; p < shapes.part_count(object); ++p) {
    const Part& part = shapes.parts[slot.part + p];
    for (int v = part.first; v <= part.last; ++v)
      box.include(box_around(shapes.vertices[slot.vertex + v], part.radius));
  }
  const double x = box.x1 - box.x0, y = box.y1 - box.y0, longer = std::max(x, y), shorter = std::min(x, y);
  BodyDiscs discs;
  if (!(shorter > 0.0 && longer >= kLong * shorter && std::isfinite(longer))) {
    discs.count = 1, discs.centres[0] = shapes.centre[object], discs.radius = shapes.radius[object];
    return discs;
  }
  discs.count = static_cast<int>(clip(std::round(kDiscsPerSide * longer / shorter), 2, BodyDiscs::kMost));
  const double spacing = longer / discs.count;
  discs.radius = 0.5 * norm({spacing, shorter});
  const Vec2 middle{0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1)};
  for (int k = 0; k < discs.count; ++k) {
    const double along = (k - 0.5 * (discs.count - 1)) * spacing;
    discs.centres[k] = middle + (x >= y ? Vec2{along, 0.0} : Vec2{0.0, along});
  }
  return discs;
}

}  // namespace irsim
