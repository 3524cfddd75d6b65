// Fog over the world: cells that no robot has seen yet (reference: section 9.3).
#pragma once

#include <array>
#include <vector>

#include "fields.hpp"
#include "geometry/vec.hpp"

namespace irsim {

struct State;
struct Workspace;
struct World;

constexpr int kMostFogCells = 1 << 22;  // along an axis

/// A robot without lidar that clears the fog in its field of view.
struct FogView {
  int object;
  double angle, reach;  // [rad], [m]
  bool occlusion;       // what others hide stays in the fog
  static constexpr auto fields() {
    using V = FogView;
    return std::make_tuple(field("object", &V::object), field("angle", &V::angle), field("reach", &V::reach),
                           field("occlusion", &V::occlusion));
  }
};

/// Cell (i, j), i along x, is number i * rows + j.
struct Fog {
  std::array<double, 2> origin, size;  // lower left corner, extent [m]
  int columns, rows;
  std::vector<int> carriers;   // robots whose first lidar clears it
  std::vector<FogView> views;  // and those that look without one
  static constexpr auto fields() {
    using F = Fog;
    return std::make_tuple(field("origin", &F::origin), field("size", &F::size), field("columns", &F::columns),
                           field("rows", &F::rows), field("carriers", &F::carriers), field("views", &F::views));
  }

  std::size_t cells() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  Vec2 cell() const { return {size[0] / columns, size[1] / rows}; }
};

/// Mark in `state.explored` what the robots of world w see now.
void lift_fog(const World& world, State& state, int w, Workspace& work);

}  // namespace irsim
