// A beam through a grid of cells.
//
// Amanatides, Woo: A Fast Voxel Traversal Algorithm for Ray Tracing, Eurographics 1987; free space is crossed in leaps
// as long as the clearance of the cell allows.
#pragma once

#include "maps/occupancy.hpp"

namespace irsim {

/// Beams from one point. Coordinates are counted in cells from the corner of the grid, distances are in metres.
class CellWalk {
 public:
  CellWalk(const OccupancyGrid& grid, Vec2 from)
      : grid_(grid),
        x_((from.x - grid.origin().x) / grid.cell().x),
        y_((from.y - grid.origin().y) / grid.cell().y),
        per_cell_{1.0 / grid.cell().x, 1.0 / grid.cell().y} {}

  /// The distance in (nearest, limit] at which a beam in direction `beam` (unit length) first meets the outline of the
  /// occupied cells, or infinity. A point of two cells that share a corner belongs to the outline.
  double hit(Vec2 beam, double nearest, double limit) const {
    const double dx = beam.x * per_cell_.x, dy = beam.y * per_cell_.y;
    Axis x{x_, dx, 1.0 / dx, grid_.columns(), 0}, y{y_, dy, 1.0 / dy, grid_.rows(), 0};
    double t = std::max(x.entry(), y.entry());
    if (!(t <= limit)) return kInfinity;
    x.enter(t), y.enter(t);
    if (!x.inside() || !y.inside()) return kInfinity;
    bool solid = grid_.clearance(x.cell, y.cell) == 0;
    if (solid && t > nearest) return t;  // from outside the grid
    while (true) {
      const int leap = solid ? 1 : grid_.clearance(x.cell, y.cell);
      const double tx = x.leave(leap), ty = y.leave(leap);
      const bool along_x = tx < ty;
      t = along_x ? tx : ty;
      if (!(t <= limit)) return kInfinity;
      const bool corner = along_x ? x.advance(y, leap, t) : y.advance(x, leap, t);
      if (corner && t > nearest) {
        const int i = along_x ? x.border() : line_near(x, t), j = along_x ? line_near(y, t) : y.border();
        const int full =
            grid_.occupied(i - 1, j - 1) + grid_.occupied(i, j - 1) + grid_.occupied(i - 1, j) + grid_.occupied(i, j);
        if (full > 0 && full < 4) return t;
      }
      const bool here = x.inside() && y.inside();
      const bool now = here && grid_.clearance(x.cell, y.cell) == 0;
      if (now != solid && t > nearest) return t;
      if (!here) return kInfinity;
      solid = now;
    }
  }

 private:
  static constexpr double kCorner = 1e-10;  // so near to a corner a beam passes through it [cells]

  struct Axis {
    double start, step, inverse;  // [cells], [cells per metre]
    int count, cell;

    bool inside() const { return cell >= 0 && cell < count; }
    /// When the beam comes into the grid: infinity if never, 0 if it starts there.
    double entry() const {
      if (start < 0.0) return step > 0.0 ? -start * inverse : kInfinity;
      if (start > count) return step < 0.0 ? (count - start) * inverse : kInfinity;
      return start == start ? 0.0 : kInfinity;
    }
    /// The cell at distance t, which is inside the grid but for rounding; on a border the one the beam goes to.
    void enter(double t) {
      const double at = t > 0.0 ? start + t * step : start;
      if (t > 0.0 && !(at > -1.0 && at < count + 1.0)) return void(cell = -1);
      const double line = std::floor(at);
      cell = static_cast<int>(line);
      if (at == line && step < 0.0) --cell;
      if (cell == count && at - count <= kCorner && step <= 0.0) --cell;
      if (cell == -1 && at >= -kCorner && step >= 0.0) cell = 0;
      if (t > 0.0 && cell == count && at - count <= kCorner) cell = count - 1;
      if (t > 0.0 && cell == -1 && at >= -kCorner) cell = 0;
    }
    /// When the beam leaves the cells less than `leap` away from its own.
    double leave(int leap) const {
      if (step > 0.0) return (cell + leap - start) * inverse;
      return step < 0.0 ? (cell - leap + 1 - start) * inverse : kInfinity;
    }
    /// Go on to the next cell after a leap along this axis; `other` follows. Whether that is at a corner.
    bool advance(Axis& other, int leap, double t) {
      cell += step > 0.0 ? leap : -leap;
      const double at = other.start + t * other.step, line = std::floor(at);
      const int low = other.cell - leap + 1, high = other.cell + leap - 1;
      other.cell = std::min(std::max(static_cast<int>(line), low), high);
      return at - line < kCorner || at - line > 1.0 - kCorner;
    }
    /// The grid line behind which the cell lies, seen along the beam.
    int border() const { return step > 0.0 ? cell : cell + 1; }
  };
  /// The grid line next to the beam at distance t.
  static int line_near(const Axis& axis, double t) { return static_cast<int>(std::lround(axis.start + t * axis.step)); }

  const OccupancyGrid& grid_;
  double x_, y_;
  Vec2 per_cell_;
};

}  // namespace irsim
