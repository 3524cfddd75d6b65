// The cells on which grid planners search, and which of them are open. Nodes are the centres of cells.
#pragma once

#include <cstdint>
#include <vector>

#include "planning/space.hpp"

namespace irsim {

/// nx * ny cells. Node n = j * nx + i is the centre of cell (i, j), i along x.
struct Lattice {
  int nx, ny;
  Vec2 origin, cell;  // [m]

  /// Cells of about `resolution` [m] that fill `bounds`; larger cells if there would be too many.
  static Lattice over(const Box& bounds, double resolution);

  int nodes() const { return nx * ny; }
  int node(int i, int j) const { return j * nx + i; }
  bool holds(int i, int j) const { return i >= 0 && j >= 0 && i < nx && j < ny; }
  Vec2 at(int i, int j) const { return {origin.x + (i + 0.5) * cell.x, origin.y + (j + 0.5) * cell.y}; }
  Vec2 at(int node) const { return at(node % nx, node / nx); }
  /// Column and row of the cell that contains a point, or of the nearest cell.
  int column(double x) const { return index((x - origin.x) / cell.x, nx); }
  int row(double y) const { return index((y - origin.y) / cell.y, ny); }
  int nearest(Vec2 p) const { return node(column(p.x), row(p.y)); }

 private:
  static int index(double cells, int count) { return static_cast<int>(clip(std::floor(cells), 0.0, count - 1.0)); }
};

/// Which nodes are open, computed when it is asked for. A node is open if the body may be there and may move from there
/// to each free neighbor (to a diagonal one if both cells beside the diagonal are free, too). Every step between open
/// nodes that cuts no corner is thus free of collisions.
class OpenCells {
 public:
  OpenCells(const Lattice& lattice, const Space& space, std::vector<std::uint8_t>& memory);

  bool open(int i, int j) {
    if (!lattice_.holds(i, j)) return false;
    std::uint8_t& known = known_[lattice_.node(i, j)];
    if (!(known & kOpenKnown)) find(i, j);
    return known & kOpen;
  }

 private:
  static constexpr std::uint8_t kFreeKnown = 1, kFree = 2, kOpenKnown = 4, kOpen = 8;
  void find(int i, int j);
  bool free(int i, int j);
  bool own_cells(const Shapes& shapes, int id) const;
  bool clear_around(int i, int j) const;

  const Lattice& lattice_;
  const Space& space_;
  std::uint8_t* known_;
};

}  // namespace irsim
