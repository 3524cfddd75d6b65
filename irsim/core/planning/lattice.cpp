#include "planning/lattice.hpp"

#include <algorithm>

namespace irsim {
namespace {

constexpr double kMaxNodes = 16e6;  // larger lattices get a coarser resolution

}  // namespace

Lattice Lattice::over(const Box& bounds, double resolution) {
  const double width = bounds.x1 - bounds.x0, height = bounds.y1 - bounds.y0;
  const double cells = width / resolution * (height / resolution);
  if (cells > kMaxNodes) resolution *= std::sqrt(cells / kMaxNodes);
  const int nx = static_cast<int>(std::max(1.0, std::round(width / resolution)));
  const int ny = static_cast<int>(std::max(1.0, std::round(height / resolution)));
  return {nx, ny, {bounds.x0, bounds.y0}, {width / nx, height / ny}};
}

OpenCells::OpenCells(const Lattice& lattice, const Space& space, std::vector<std::uint8_t>& memory)
    : lattice_(lattice), space_(space) {
  memory.assign(static_cast<std::size_t>(lattice.nodes()), 0);
  known_ = memory.data();
}

bool OpenCells::free(int i, int j) {
  if (!lattice_.holds(i, j)) return false;
  std::uint8_t& known = known_[lattice_.node(i, j)];
  if (!(known & kFreeKnown)) known |= kFreeKnown | (space_.free(lattice_.at(i, j)) ? kFree : 0);
  return known & kFree;
}

/// Whether an object is a map with the cells of this lattice.
bool OpenCells::own_cells(const Shapes& shapes, int id) const {
  if (!shapes.is_map(id)) return false;
  const OccupancyGrid& grid = *shapes.parts[shapes.body[id].part].cells;
  const Vec2 cell = lattice_.cell, gap = grid.origin() - lattice_.origin;
  return norm(grid.cell() - cell) <= 1e-9 * norm(cell) && norm(gap) <= 1e-6 * norm(cell);
}

/// Whether no obstacle is near enough to matter for steps to and from a node. Cells of a map that coincide with this
/// lattice do not matter: each is as large as a step, so steps between free nodes meet none of them.
bool OpenCells::clear_around(int i, int j) const {
  const Box& own = space_.body.box();
  const Vec2 p = lattice_.at(i, j);
  const Box around{p.x + own.x0 - lattice_.cell.x, p.y + own.y0 - lattice_.cell.y, p.x + own.x1 + lattice_.cell.x,
                   p.y + own.y1 + lattice_.cell.y};
  bool clear = true;
  space_.blockers.grid.query(
      around, [&](int id) { clear = clear && (!space_.blockers.counts(id) || own_cells(space_.blockers.shapes, id)); });
  if (!clear || space_.blockers.others == nullptr) return clear;
  const std::vector<Footprint>& others = *space_.blockers.others;
  return std::none_of(others.begin(), others.end(), [&](const Footprint& other) { return around.meets(other.box); });
}

void OpenCells::find(int i, int j) {
  std::uint8_t& known = known_[lattice_.node(i, j)];
  known |= kOpenKnown;
  if (!free(i, j)) return;
  if (space_.region != nullptr || !clear_around(i, j)) {
    const Vec2 here = lattice_.at(i, j);
    for (int dj = -1; dj <= 1; ++dj) {
      for (int di = -1; di <= 1; ++di) {
        if ((di == 0 && dj == 0) || !free(i + di, j + dj)) continue;
        if (di != 0 && dj != 0 && !(free(i + di, j) && free(i, j + dj))) continue;
        if (!space_.clear(here, lattice_.at(i + di, j + dj))) return;
      }
    }
  }
  known |= kOpen;
}

}  // namespace irsim
