// Distance between two footprints.
#pragma once

#include "geometry/shapes.hpp"

namespace irsim {

/// Distance [m] between the surfaces of two closed footprints, negative if they overlap. The depth of a circle is that
/// of its centre plus its radius. The depth of two outlines is how deep a corner of one lies inside the other, 0 if
/// they cross without such a corner. NaN if a footprint is not finite.
double distance(const Footprint& a, const Footprint& b);

}  // namespace irsim
