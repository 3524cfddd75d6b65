// Fog: the cells of the world that no robot has seen yet.
#pragma once

#include <array>
#include <vector>

#include "fields.hpp"
#include "geometry/vec.hpp"
#include "sensing/view.hpp"

namespace irsim {

struct State;
struct Workspace;
struct World;

constexpr int kMaxFogCells = 1 << 22;  // largest number of cells along an axis

/// Cells over the world. Cell (i, j), i along x, has the index i * rows + j.
struct Fog {
  std::array<double, 2> origin, size;  // lower left corner, extent [m]
  int columns, rows;
  std::vector<int> carriers;  // robots that clear the fog with their first lidar
  std::vector<View> views;    // fields of view of robots that clear the fog without a lidar
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using F = Fog;
    return visit(field("origin", &F::origin), field("size", &F::size), field("columns", &F::columns),
                 field("rows", &F::rows), field("carriers", &F::carriers), field("views", &F::views));
  }

  std::size_t cells() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  Vec2 cell() const { return {size[0] / columns, size[1] / rows}; }
};

/// Mark the cells that the robots of world w see now in `state.explored`.
void lift_fog(const World& world, State& state, int w, Workspace& work);

}  // namespace irsim
