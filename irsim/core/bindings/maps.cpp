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
std::vector<std::uint8_t> by_row(const Occupied& flags) {
  const std::size_t nx = flags.shape(0), ny = flags.shape(1);
  std::vector<std::uint8_t> rows(nx * ny);
  for (std::size_t i = 0; i < nx; ++i)
    for (std::size_t j = 0; j < ny; ++j) rows[j * nx + i] = flags.data()[i * ny + j];
  return rows;
}

OccupancyGrid make_grid(const Occupied& occupied, const Two& origin, const Two& cell,
                        const std::optional<Occupied>& unknown) {
  const std::size_t nx = occupied.shape(0), ny = occupied.shape(1);
  if (unknown && (unknown->shape(0) != nx || unknown->shape(1) != ny))
    throw nb::value_error("occupied and unknown cells must have the same shape");
  return {static_cast<int>(nx), static_cast<int>(ny), {origin[0], origin[1]},
          {cell[0], cell[1]},   by_row(occupied),     unknown ? by_row(*unknown) : std::vector<std::uint8_t>()};
}

/// (nx, ny) `value` of each cell.
template <class Value>
nb::object by_column(const OccupancyGrid& grid, Value&& value) {
  const std::size_t nx = grid.columns(), ny = grid.rows();
  std::vector<std::uint8_t> out(nx * ny);
  for (std::size_t i = 0; i < nx; ++i)
    for (std::size_t j = 0; j < ny; ++j)
      out[i * ny + j] = static_cast<std::uint8_t>(value(static_cast<int>(i), static_cast<int>(j)));
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
          [](OccupancyGrid* self, const Occupied& occupied, const Two& origin, const Two& cell,
             const std::optional<Occupied>& unknown) {
            new (self) OccupancyGrid(make_grid(occupied, origin, cell, unknown));
          },
          nb::arg("occupied"), nb::arg("origin"), nb::arg("cell"), nb::arg("unknown") = nb::none())
      .def_prop_ro("shape", [](const OccupancyGrid& g) { return std::make_tuple(g.columns(), g.rows()); })
      .def_prop_ro("origin", [](const OccupancyGrid& g) { return std::make_tuple(g.origin().x, g.origin().y); })
      .def_prop_ro("cell", [](const OccupancyGrid& g) { return std::make_tuple(g.cell().x, g.cell().y); })
      .def_prop_ro("count", &OccupancyGrid::count)
      .def_prop_ro("occupied",
                   [](const OccupancyGrid& g) { return by_column(g, [&](int i, int j) { return g.occupied(i, j); }); })
      .def_prop_ro("clearance",
                   [](const OccupancyGrid& g) { return by_column(g, [&](int i, int j) { return g.clearance(i, j); }); })
      .def_prop_ro("unknown",
                   [](const OccupancyGrid& g) {
                     return g.closed() == nullptr ? nb::none()
                                                  : by_column(g, [&](int i, int j) { return g.unknown(i, j); });
                   })
      .def_prop_ro("closed_count",
                   [](const OccupancyGrid& g) { return g.closed() == nullptr ? g.count() : g.closed()->count(); })
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
