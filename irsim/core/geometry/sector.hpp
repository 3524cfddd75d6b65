// Which footprints reach into a sector of a disc.
#pragma once

#include "geometry/shapes.hpp"

namespace irsim {

/// The closed set of points within `reach` of the apex whose bearing differs from `middle` by at most `half`. A `half`
/// of pi or more gives the whole disc.
struct Sector {
  Vec2 apex;
  double middle;  // bearing of the axis [rad]
  double half;    // half the opening angle [rad]
  double reach;   // [m]
};

/// Whether any point of a closed footprint lies in the sector. Exact but for rounding.
bool meets(const Footprint& body, const Sector& sector);

}  // namespace irsim
