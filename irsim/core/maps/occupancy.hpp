// Occupancy grids: maps of square or oblong cells, some of them occupied, some of them perhaps unknown.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

/// Occupied cells are closed boxes. Cell (i, j), i along x, lies between corners (i, j) and (i + 1, j + 1). A grid
/// never changes, so all worlds that have the map share it. It takes four bytes per cell. Beams, sight and bodies pass
/// through unknown cells; planners and random places avoid them, as they use `closed`.
class OccupancyGrid {
 public:
  /// `occupied`: (columns * rows,) row by row from the lowest, non-zero where occupied; `unknown`: likewise, or empty.
  OccupancyGrid(int columns, int rows, Vec2 origin, Vec2 cell, const std::vector<std::uint8_t>& occupied,
                const std::vector<std::uint8_t>& unknown = {});

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  Vec2 origin() const { return origin_; }
  Vec2 cell() const { return cell_; }
  Vec2 corner(int i, int j) const { return {origin_.x + i * cell_.x, origin_.y + j * cell_.y}; }
  Box box(int i, int j) const {
    const Vec2 low = corner(i, j), high = corner(i + 1, j + 1);
    return {low.x, low.y, high.x, high.y};
  }
  /// The box around all occupied cells; not finite if no cell is occupied.
  const Box& bounds() const { return bounds_; }
  std::int64_t count() const { return count_; }
  /// The grid in which unknown cells are occupied, too; null if all cells are known.
  const std::shared_ptr<const OccupancyGrid>& closed() const { return closed_; }
  bool unknown(int i, int j) const { return closed_ != nullptr && closed_->occupied(i, j) && !occupied(i, j); }
  /// Whether a box may meet an unknown cell.
  bool any_unknown(const Box& area) const {
    return closed_ != nullptr && closed_->any_in(area, [this](int i, int j) { return !occupied(i, j); });
  }

  /// Distance to the nearest occupied cell in steps to any of the 8 neighbors: 0 is occupied, 255 is far.
  int clearance(int i, int j) const {
    const std::size_t k = at(i, j);
    return std::min(std::min(free_[0][k], free_[1][k]), std::min(free_[2][k], free_[3][k]));
  }
  /// (rows, columns) For each cell, the side of the largest free square, at most 255, that has the cell in its corner
  /// and extends from it to +x, or to -x if `left`, and to +y, or to -y if `down`. 0 means that the cell is occupied.
  /// Squares may extend beyond the grid.
  const std::uint8_t* free_squares(bool left, bool down) const { return free_[left + 2 * down].data(); }
  bool inside(int i, int j) const { return i >= 0 && j >= 0 && i < columns_ && j < rows_; }
  /// Whether a cell is occupied; cells outside the grid are not.
  bool occupied(int i, int j) const { return inside(i, j) && free_[0][at(i, j)] == 0; }
  /// Whether the outline of the occupied cells passes through the lower left corner of cell (i, j).
  bool on_outline(int i, int j) const;
  /// The first occupied column of row j in [from, to], or -1. The interval must lie inside the grid.
  int next_occupied(int j, int from, int to) const {
    if (from > to) return -1;
    const std::uint8_t* row = free_[0].data() + at(0, j);
    const void* found = std::memchr(row + from, 0, static_cast<std::size_t>(to - from + 1));
    return found == nullptr ? -1 : static_cast<int>(static_cast<const std::uint8_t*>(found) - row);
  }
  /// Whether all cells within `reach` [m] of a point are certainly free. If false, they may still be free.
  bool clear_of(Vec2 point, double reach) const;

  /// Call `visit(i, j)` for the occupied cells that may meet a box until it returns true. Returns whether it did.
  template <class Visit>
  bool any_in(const Box& area, Visit&& visit) const {
    if (count_ == 0 || !area.meets(bounds_)) return false;
    const auto index = [](double at, double size, int count) {
      return static_cast<int>(clip(std::floor(at / size), 0.0, count - 1.0));
    };
    const int i0 = std::max(0, index(area.x0 - origin_.x, cell_.x, columns_) - 1);
    const int j0 = std::max(0, index(area.y0 - origin_.y, cell_.y, rows_) - 1);
    const int i1 = index(area.x1 - origin_.x, cell_.x, columns_), j1 = index(area.y1 - origin_.y, cell_.y, rows_);
    for (int j = j0; j <= j1; ++j) {
      for (int i = next_occupied(j, i0, i1); i >= 0; i = next_occupied(j, i + 1, i1)) {
        if (visit(i, j)) return true;
      }
    }
    return false;
  }

  /// Corners of the outline of the occupied cells, one list per ring, with straight runs merged. The occupied side is
  /// on the left, so outer rings are counter-clockwise and holes clockwise. Cells that share only a corner have
  /// separate rings.
  std::vector<std::vector<Vec2>> outline() const;

 private:
  std::size_t at(int i, int j) const { return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + i; }

  int columns_, rows_;
  Vec2 origin_, cell_;
  Box bounds_;
  std::int64_t count_ = 0;
  std::array<std::vector<std::uint8_t>, 4> free_;  // sides of free squares, one array per direction
  std::shared_ptr<const OccupancyGrid> closed_;
};

/// Whether a closed disc meets an occupied cell; if so, `where` is the point of such a cell nearest to the centre.
bool disc_meets(const OccupancyGrid& grid, Vec2 centre, double radius, Vec2& where);
/// Whether a polyline of `edges` edges meets an occupied cell; if so, `where` is a point of both. If `filled`, the area
/// inside the polyline counts, too, and vertices[edges] repeats vertices[0].
bool outline_meets(const OccupancyGrid& grid, const Vec2* vertices, int edges, bool filled, const Box& box,
                   Vec2& where);

}  // namespace irsim
