// Occupancy grids and gradient noise.
#include "bindings/bound_state.hpp"
#include "bindings/helpers.hpp"
#include "maps/occupancy.hpp"
#include "maps/perlin.hpp"
#include "maps/walk.hpp"

namespace irsim {
namespace {

using Occupied = nb::ndarray<const std::uint8_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Two = std::array<double, 2>;

/// Python hands over an (nx, ny) array with i along x, while the core stores rows along x.
std::shared_ptr<OccupancyGrid> make_grid(const Occupied& occupied, const Two& origin, const Two& cell) {
  const std::size_t nx = occupied.shape(0), ny = occupied.shape(1);
  std::vector<std::uint8_t> rows(nx * ny);
  for (std::size_t i = 0; i < nx; ++i)
    for (std::size_t j = 0; j < ny; ++j) rows[j * nx + i] = occupied.data()[i * ny + j];
  return std::make_shared<OccupancyGrid>(static_cast<int>(nx), static_cast<int>(ny), Vec2{origin[0], origin[1]},
                                         Vec2{cell[0], cell[1]}, rows);
}

nb::object by_column(const OccupancyGrid& grid, bool clearance) {
  const std::size_t nx = grid.columns(), ny = grid.rows();
  std::vector<std::uint8_t> out(nx * ny);
  for (std::size_t i = 0; i < nx; ++i)
    for (std::size_t j = 0; j < ny; ++j) {
      const int c = grid.clearance(static_cast<int>(i), static_cast<int>(j));
      out[i * ny + j] = static_cast<std::uint8_t>(clearance ? c : c == 0);
    }
  return own(std::move(out), {nx, ny});
}

nb::list outline_rings(const OccupancyGrid& grid) {
  nb::list out;
  for (const std::vector<Vec2>& ring : grid.outline()) {
    std::vector<double> numbers;
    for (const Vec2& p : ring) numbers.insert(numbers.end(), {p.x, p.y});
    out.append(own(std::move(numbers), {ring.size(), 2}));
  }
  return out;
}

nb::object noise(const std::vector<int>& permutation, int columns, int rows, double complexity, double fill,
                 int fractal, double attenuation) {
  Permutation p;
  if (permutation.size() != p.size()) throw nb::value_error("a permutation must have 256 numbers");
  for (std::size_t k = 0; k < p.size(); ++k) p[k] = static_cast<std::uint8_t>(permutation[k]);
  if (columns < 1 || rows < 1) throw nb::value_error("a grid needs at least one cell");
  const std::size_t nx = columns, ny = rows;
  const std::vector<std::uint8_t> cells = perlin_cells({columns, rows, complexity, fill, fractal, attenuation}, p);
  std::vector<std::uint8_t> out(nx * ny);
  for (std::size_t i = 0; i < nx; ++i)
    for (std::size_t j = 0; j < ny; ++j) out[i * ny + j] = cells[j * nx + i];
  return own(std::move(out), {nx, ny});
}

}  // namespace

void bind_maps(nb::module_& m) {
  nb::class_<OccupancyGrid>(m, "OccupancyGrid")
      .def(
          "__init__",
          [](OccupancyGrid* self, const Occupied& occupied, const Two& origin, const Two& cell) {
            new (self) OccupancyGrid(std::move(*make_grid(occupied, origin, cell)));
          },
          nb::arg("occupied"), nb::arg("origin"), nb::arg("cell"))
      .def_prop_ro("shape", [](const OccupancyGrid& g) { return std::make_tuple(g.columns(), g.rows()); })
      .def_prop_ro("origin", [](const OccupancyGrid& g) { return std::make_tuple(g.origin().x, g.origin().y); })
      .def_prop_ro("cell", [](const OccupancyGrid& g) { return std::make_tuple(g.cell().x, g.cell().y); })
      .def_prop_ro("count", &OccupancyGrid::count)
      .def_prop_ro("occupied", [](const OccupancyGrid& g) { return by_column(g, false); })
      .def_prop_ro("clearance", [](const OccupancyGrid& g) { return by_column(g, true); })
      .def("outline", &outline_rings)
      .def(
          "cast",
          [](const OccupancyGrid& g, const Two& from, const Two& direction, double limit) {
            return CellWalk(g, {from[0], from[1]}).hit({direction[0], direction[1]}, 1e-9, limit);
          },
          nb::arg("from_"), nb::arg("direction"), nb::arg("limit"));
  m.def("perlin_cells", &noise, nb::arg("permutation"), nb::arg("columns"), nb::arg("rows"), nb::arg("complexity"),
        nb::arg("fill"), nb::arg("fractal"), nb::arg("attenuation"));
}

}  // namespace irsim
