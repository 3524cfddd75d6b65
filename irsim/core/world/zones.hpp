// Lines and regions that objects cross or enter. They are neither solid nor seen.
#pragma once

#include <vector>

#include "geometry/shapes.hpp"

namespace irsim {

/// Zones in the world frame. A zone is a part: a linestring of two points is a line, a circle or polygon is a region.
struct Zones {
  explicit Zones(const std::vector<Outline>& outlines = {});

  int count() const { return shapes.objects(); }
  bool is_line(int zone) const { return shapes.parts[zone].kind == Kind::linestring; }
  Footprint footprint(int zone) const { return outlines.footprint(shapes, zone); }

  Shapes shapes;
  Outlines outlines;
};

/// The watched zones and views of a world at the end of the last step.
struct Watched {
  std::vector<Vec2> position;        // (N,); empty before the first look
  std::vector<std::uint8_t> inside;  // (zones * N,) whether an object overlaps a region
  std::vector<std::uint8_t> seen;    // (views * N,) whether an object is seen
};

}  // namespace irsim
