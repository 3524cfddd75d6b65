// Which footprints reach into a slice of a disc.
#pragma once

#include "geometry/shapes.hpp"

namespace irsim {

/// Points within `reach` of the apex whose bearing is within `half` of `middle`; closed. `half` of pi or more: the
/// disc.
struct Sector {
  Vec2 apex;
  double middle;  // bearing of the axis [rad]
  double half;    // half the opening angle [rad]
  double reach;   // [m]
};

/// Whether any point of a closed footprint lies in the sector. Exact but for rounding.
bool meets(const Footprint& body, const Sector& sector);

}  // namespace irsim
