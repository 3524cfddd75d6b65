// How far two footprints are from each other.
#pragma once

#include "geometry/shapes.hpp"

namespace irsim {

/// Distance [m] between the surfaces of two closed footprints. Negative where they overlap: a circle reaches as deep as
/// its centre does, plus its radius; of two outlines the deepest corner of one inside the other counts (0 if they cross
/// without one). NaN where a footprint is not finite.
double distance(const Footprint& a, const Footprint& b);

}  // namespace irsim
