// The cells of a map of gradient noise, drawn for each scene.
#pragma once

#include "maps/perlin.hpp"
#include "shapes/grid_cells.hpp"

namespace irsim {

struct PerlinCells {
  std::array<int, 2> size;          // cells of the noise along x and y
  int every;                        // cells along a side of a block, which is occupied if one of its cells is
  std::array<double, 2> origin;     // lower left corner of the map, world frame [m]
  std::array<double, 2> cell_size;  // [m]
  double complexity, fill;
  int fractal;
  double attenuation;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using P = PerlinCells;
    return visit(field("size", &P::size), field("every", &P::every), field("origin", &P::origin),
                 field("cell_size", &P::cell_size), field("complexity", &P::complexity), field("fill", &P::fill),
                 field("fractal", &P::fractal), field("attenuation", &P::attenuation));
  }
};

constexpr bool is_drawn(const PerlinCells&) { return true; }

inline Outline outline(const PerlinCells& p, const Draws& draws, std::uint64_t) {
  Draws own = draws;
  own.stream = static_cast<std::uint64_t>(Stream::map);
  const PerlinNoise noise{p.size[0], p.size[1], p.complexity, p.fill, p.fractal, p.attenuation};
  std::vector<std::uint8_t> cells = perlin_cells(noise, draw_permutation(own));
  const int step = std::max(1, p.every), columns = (p.size[0] + step - 1) / step, rows = (p.size[1] + step - 1) / step;
  if (step > 1) {
    std::vector<std::uint8_t> blocks(static_cast<std::size_t>(columns) * rows, 0);
    for (int j = 0; j < p.size[1]; ++j) {
      for (int i = 0; i < p.size[0]; ++i)
        blocks[static_cast<std::size_t>(j / step) * columns + i / step] |=
            cells[static_cast<std::size_t>(j) * p.size[0] + i];
    }
    cells = std::move(blocks);
  }
  return cells_outline(std::make_shared<OccupancyGrid>(columns, rows, Vec2{p.origin[0], p.origin[1]},
                                                       Vec2{p.cell_size[0], p.cell_size[1]}, cells));
}

}  // namespace irsim
