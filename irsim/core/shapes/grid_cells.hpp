// The occupied cells of a map, in world coordinates: the pose of the object does not move them.
#pragma once

#include <memory>

#include "fields.hpp"
#include "geometry/shapes.hpp"

namespace irsim {

struct GridCells {
  std::shared_ptr<OccupancyGrid> grid;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("grid", &GridCells::grid));
  }
};

inline Outline outline(const GridCells& cells, const Draws&, std::uint64_t) { return cells_outline(cells.grid); }

}  // namespace irsim
