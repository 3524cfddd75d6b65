// Lines and regions that objects cross or enter, and regions of other ground. They are neither solid nor seen.
#pragma once

#include <vector>

#include "fields.hpp"
#include "geometry/shapes.hpp"

namespace irsim {

/// The ground of a region: what it does to wheels.
struct Ground {
  int zone;
  double slip;       // mean share of a wheel's way that is lost, 0 to 1
  double slip_std;   // standard deviation of that share
  double slip_time;  // time in which a deviation falls to 1 / e [s]; 0: each step has its own
  double grip;       // factor on the friction of wheels
  double spread;     // see `Footing`
  double traction;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using G = Ground;
    return visit(field("zone", &G::zone), field("slip", &G::slip), field("slip_std", &G::slip_std),
                 field("slip_time", &G::slip_time), field("grip", &G::grip), field("spread", &G::spread),
                 field("traction", &G::traction));
  }
};

/// Zones in the world frame. A zone is a part: a linestring of two points is a line, a circle or polygon is a region.
struct Zones {
  explicit Zones(const std::vector<Outline>& outlines = {}, std::vector<Ground> grounds = {});

  int count() const { return shapes.objects(); }
  bool is_line(int zone) const { return shapes.parts[zone].kind == Kind::linestring; }
  Footprint footprint(int zone) const { return outlines.footprint(shapes, zone); }
  /// Whether a point lies in a region.
  bool covers(int zone, Vec2 at) const;
  /// The ground at a point: of the last region there; null where no region has one.
  const Ground* ground_at(Vec2 at) const;

  Shapes shapes;
  Outlines outlines;
  std::vector<Ground> grounds;  // in the order of their zones
};

/// The watched zones and views of a world at the end of the last step.
struct Watched {
  std::vector<Vec2> position;        // (N,); empty before the first look
  std::vector<std::uint8_t> inside;  // (zones * N,) whether an object overlaps a region
  std::vector<std::uint8_t> seen;    // (views * N,) whether an object is seen
};

}  // namespace irsim
