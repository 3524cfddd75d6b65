// The walls of a room: the area outside of the outline is solid.
#pragma once

#include "shapes/polygon.hpp"

namespace irsim {

struct Room {
  Corners vertices;  // body frame [m], in either order
  static constexpr auto fields() { return std::make_tuple(field("vertices", &Room::vertices)); }
};

inline Outline outline(const Room& r, const Draws&, std::uint64_t) { return {Kind::room, points(r.vertices)}; }

}  // namespace irsim
