// Narrow phase: the exact test of two footprints.
#pragma once

#include "geometry/shapes.hpp"

namespace irsim {

/// Whether two closed footprints meet; if so, `where` is a point of both.
bool touch(const Footprint& a, const Footprint& b, Vec2& where);

inline bool touch(const Footprint& a, const Footprint& b) {
  Vec2 where;
  return touch(a, b, where);
}

}  // namespace irsim
