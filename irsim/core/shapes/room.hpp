// The walls of a room: the area outside of the outline is solid.
#pragma once

#include "shapes/polygon.hpp"

namespace irsim {

struct Room {
  Corners vertices;  // body frame [m], in either order
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("vertices", &Room::vertices));
  }
};

inline Outline outline(const Room& r, const Draws&, std::uint64_t) { return {Kind::room, points(r.vertices)}; }

}  // namespace irsim
