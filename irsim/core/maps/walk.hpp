// Ray casting in a grid of cells.
//
// Amanatides, Woo: A Fast Voxel Traversal Algorithm for Ray Tracing, Eurographics 1987. Free areas are crossed in
// leaps, each through the largest free square ahead that begins at the cell.
#pragma once

#include <cstddef>

#include "maps/occupancy.hpp"

namespace irsim {

/// Beams from one point. Coordinates are in cells from the corner of the grid, distances in metres. An axis is mirrored
/// for beams in its negative direction, so that all beams go up: cell i of the grid then has the index -1 - i.
class CellWalk {
 public:
  CellWalk(const OccupancyGrid& grid, Vec2 from)
      : grid_(grid),
        per_cell_{1.0 / grid.cell().x, 1.0 / grid.cell().y},
        x_((from.x - grid.origin().x) / grid.cell().x, grid.columns(), 1),
        y_((from.y - grid.origin().y) / grid.cell().y, grid.rows(), grid.columns()) {}

  /// The distance in (nearest, limit] at which a beam in direction `beam` (unit length) first meets the outline of the
  /// occupied cells, or infinity. A point of two cells that share a corner belongs to the outline.
  double hit(Vec2 beam, double nearest, double limit) const {
    const bool left = x_.goes_down(beam.x), down = y_.goes_down(beam.y);
    const Way &x = x_.ways[left], &y = y_.ways[down];
    const Rate dx(beam.x * per_cell_.x), dy(beam.y * per_cell_.y);
    int i = x.cell, j = y.cell;
    double t = 0.0;
    if (!x.inside(i) || !y.inside(j)) {
      t = std::max(x.entry(dx), y.entry(dy));
      if (!(t <= limit && t > 0.0)) return kInfinity;
      const double at_x = x.start + t * dx.step, at_y = y.start + t * dy.step;
      i = x.enter(at_x), j = y.enter(at_y);
      if (!x.inside(i) || !y.inside(j)) return kInfinity;
      if (t > nearest && on_line(at_x) && on_line(at_y)) {
        if (grid_.on_outline(x.line(nearest_line(at_x)), y.line(nearest_line(at_y)))) return t;
      }
    }
    const std::uint8_t* squares = grid_.free_squares(left, down);
    const auto free_ahead = [&](int i, int j) { return static_cast<int>(squares[x.index(i) + y.index(j)]); };
    int leap = free_ahead(i, j);
    bool solid = leap == 0;
    if (solid && t > nearest) return t;  // the beam enters the grid at an occupied cell
    // A beam along a grid line meets the cells on both sides of the line.
    const bool sliding = (x_.on_line && dx.much_less(dy, x_.count)) || (y_.on_line && dy.much_less(dx, y_.count));
    while (true) {
      if (solid || sliding) leap = 1;
      const double tx = (i + leap - x.start) * dx.inverse, ty = (j + leap - y.start) * dy.inverse;
      const bool along_x = tx < ty;
      t = along_x ? tx : ty;
      if (!(t <= limit)) return kInfinity;
      // Distance that the beam has come along the other axis from the border of its cell. Both values are computed and
      // one is taken, because the branch would be unpredictable.
      const double aside_x = x.start + t * dx.step - i, aside_y = y.start + t * dy.step - j;
      const double aside = along_x ? aside_y : aside_x;
      const int whole = static_cast<int>(aside), across = std::min(whole, leap - 1);
      const double rest = aside - whole;
      if ((rest < kCorner || rest > 1.0 - kCorner) && t > nearest) {
        const int line = whole + (rest > 0.5);
        if (grid_.on_outline(x.line(along_x ? i + leap : i + line), y.line(along_x ? j + line : j + leap))) return t;
      }
      i += along_x ? leap : across;
      j += along_x ? across : leap;
      const bool here = x.inside(i) && y.inside(j);
      leap = here ? free_ahead(i, j) : 1;
      const bool now = leap == 0;
      if (now != solid && t > nearest) return t;
      if (!here) return kInfinity;
      solid = now;
    }
  }

 private:
  static constexpr double kCorner = 1e-10;  // a beam this near to a corner passes through it [cells]
  static constexpr double kMaxDistance =
      1e9;  // beams that start farther away miss the grid, because rounding errors grow [cells]

  static bool on_line(double at) { return std::fabs(at - std::round(at)) < kCorner; }
  static int nearest_line(double at) { return static_cast<int>(std::lround(at)); }

  /// Progress of a beam along an axis.
  struct Rate {
    double step, inverse;  // [cells/m] and [m/cell]
    explicit Rate(double rate) : step(std::fabs(rate)), inverse(1.0 / step) {}
    /// Whether the beam makes no progress along this axis, but for rounding, while it crosses `count` cells of the
    /// other.
    bool much_less(const Rate& other, int count) const { return step * count < kCorner * other.step; }
  };

  /// One axis, in one of its two directions.
  struct Way {
    int low, high;          // the grid has the cells low to high - 1
    int cell;               // cell in which the beams start; `high` if they start outside
    std::ptrdiff_t stride;  // offset between adjacent cells in memory
    double start;

    Way(double at, int low, int count, std::ptrdiff_t stride)
        : low(low), high(low + count), cell(high), stride(stride), start(at) {
      if (at >= low && at < high) cell = static_cast<int>(std::floor(at));
    }
    bool inside(int i) const { return i >= low && i < high; }
    std::ptrdiff_t index(int i) const { return (stride < 0 ? i + 1 : i) * stride; }
    int line(int i) const { return stride < 0 ? -i : i; }
    /// Distance at which a beam enters the grid: infinity if never, 0 if it starts inside.
    double entry(const Rate& rate) const {
      if (start >= low && start < high) return 0.0;
      return start < low && start > -kMaxDistance && rate.step > 0.0 ? (low - start) * rate.inverse : kInfinity;
    }
    /// The cell of a point that is inside the grid except for rounding errors.
    int enter(double at) const {
      if (!(at >= low - kCorner && at <= high + kCorner)) return high;
      return std::min(std::max(static_cast<int>(std::floor(at)), low), high - 1);
    }
  };

  struct Axis {
    int count;
    bool at_end, on_line;  // whether the beams start at the upper end of the grid, on a grid line
    Way ways[2];           // in positive and in negative direction

    Axis(double at, int count, int stride)
        : count(count),
          at_end(at == count),
          on_line(CellWalk::on_line(at)),
          ways{{at, 0, count, stride}, {-at, -count, count, -stride}} {}
    /// Whether a beam goes in negative direction. Beams along the upper end of the grid count as such, because they
    /// pass through the last cell, too.
    bool goes_down(double rate) const { return rate < 0.0 || (at_end && rate == 0.0); }
  };

  const OccupancyGrid& grid_;
  Vec2 per_cell_;
  Axis x_, y_;
};

}  // namespace irsim
