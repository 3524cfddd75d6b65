// Exact tests of bodies against cells. Rows of the grid give the candidates; an edge or disc of the body is then tested
// against closed cells.
#include <algorithm>

#include "geometry/predicates.hpp"
#include "maps/occupancy.hpp"

namespace irsim {
namespace {

constexpr double kRounding = 1e-6;  // largest rounding error of a coordinate [cells]

struct Span {
  int first, last;
};

/// Cells of the grid that the interval [low, high] may touch along one axis; empty if first > last.
Span cells_touched(double low, double high, double origin, double cell, int count) {
  const double from = std::floor((low - origin) / cell - kRounding),
               to = std::floor((high - origin) / cell + kRounding);
  if (!(to >= 0.0 && from < count)) return {0, -1};
  return {static_cast<int>(std::max(from, 0.0)), static_cast<int>(std::min(to, count - 1.0))};
}

/// Call `test(i)` for the occupied cells of a row until it returns true. Returns whether it did.
template <class Test>
bool any_occupied(const OccupancyGrid& grid, int j, Span columns, Test&& test) {
  for (int i = grid.next_occupied(j, columns.first, columns.last); i >= 0;
       i = grid.next_occupied(j, i + 1, columns.last)) {
    if (test(i)) return true;
  }
  return false;
}

Vec2 nearest_in(const Box& box, Vec2 p) { return {clip(p.x, box.x0, box.x1), clip(p.y, box.y0, box.y1)}; }

/// Whether a closed segment meets a closed box; `where` is then about the middle of their common part.
bool segment_meets_box(Vec2 a, Vec2 b, const Box& box, Vec2& where) {
  const Box own{std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.x, b.x), std::max(a.y, b.y)};
  if (!own.meets(box)) return false;
  const double sides[] = {turn_of(a, b, {box.x0, box.y0}), turn_of(a, b, {box.x1, box.y0}),
                          turn_of(a, b, {box.x1, box.y1}), turn_of(a, b, {box.x0, box.y1})};
  const auto [least, most] = std::minmax_element(std::begin(sides), std::end(sides));
  if (*least > 0.0 || *most < 0.0) return false;
  double from = 0.0, to = 1.0;
  const Vec2 along = b - a;
  const auto cut = [&](double start, double step, double low, double high) {
    if (step == 0.0) return;
    const double enter = (low - start) / step, leave = (high - start) / step;
    from = std::max(from, std::min(enter, leave)), to = std::min(to, std::max(enter, leave));
  };
  cut(a.x, along.x, box.x0, box.x1);
  cut(a.y, along.y, box.y0, box.y1);
  where = nearest_in(box, a + along * (0.5 * (from + to)));
  return true;
}

bool edge_meets(const OccupancyGrid& grid, Vec2 a, Vec2 b, Vec2& where) {
  const Vec2 origin = grid.origin(), cell = grid.cell();
  const Vec2 low = a.y <= b.y ? a : b, high = a.y <= b.y ? b : a;
  const double slope = (high.x - low.x) / (high.y - low.y), slack = kRounding * cell.y;
  const Span rows = cells_touched(low.y, high.y, origin.y, cell.y, grid.rows());
  for (int j = rows.first; j <= rows.last; ++j) {
    // the part of the edge inside this row
    const double y0 = std::max(low.y, origin.y + j * cell.y - slack);
    const double y1 = std::min(high.y, origin.y + (j + 1) * cell.y + slack);
    double x0 = low.x + (y0 - low.y) * slope, x1 = low.x + (y1 - low.y) * slope;
    if (!std::isfinite(x0) || !std::isfinite(x1)) x0 = low.x, x1 = high.x;  // the edge is horizontal, or nearly so
    const double left = std::max(std::min(x0, x1), std::min(low.x, high.x));
    const double right = std::min(std::max(x0, x1), std::max(low.x, high.x));
    const Span columns = cells_touched(left, right, origin.x, cell.x, grid.columns());
    if (any_occupied(grid, j, columns, [&](int i) { return segment_meets_box(a, b, grid.box(i, j), where); }))
      return true;
  }
  return false;
}

}  // namespace

bool disc_meets(const OccupancyGrid& grid, Vec2 centre, double radius, Vec2& where) {
  if (grid.clear_of(centre, radius)) return false;
  const Vec2 origin = grid.origin(), cell = grid.cell();
  const double radius2 = radius * radius;
  const Span rows = cells_touched(centre.y - radius, centre.y + radius, origin.y, cell.y, grid.rows());
  for (int j = rows.first; j <= rows.last; ++j) {
    const double bottom = origin.y + j * cell.y;
    const double up = std::max(0.0, std::max(bottom - centre.y, centre.y - (bottom + cell.y)));
    const double half = std::sqrt(std::max(0.0, radius2 - up * up));
    const Span columns = cells_touched(centre.x - half, centre.x + half, origin.x, cell.x, grid.columns());
    const auto meets = [&](int i) {
      const Vec2 nearest = nearest_in(grid.box(i, j), centre);
      if (!(squared(nearest - centre) <= radius2)) return false;
      where = nearest;
      return true;
    };
    if (any_occupied(grid, j, columns, meets)) return true;
  }
  return false;
}

bool outline_meets(const OccupancyGrid& grid, const Vec2* vertices, int edges, bool filled, const Box& box,
                   Vec2& where) {
  const Vec2 middle{0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1)};
  if (grid.clear_of(middle, 0.5 * norm({box.x1 - box.x0, box.y1 - box.y0}))) return false;
  for (int k = 0; k < edges; ++k) {
    if (edge_meets(grid, vertices[k], vertices[k + 1], where)) return true;
  }
  if (!filled) return false;
  // A cell that no edge meets is entirely inside or outside, and so is a run of adjacent cells.
  const Vec2 origin = grid.origin(), cell = grid.cell();
  const Span rows = cells_touched(box.y0, box.y1, origin.y, cell.y, grid.rows());
  const Span columns = cells_touched(box.x0, box.x1, origin.x, cell.x, grid.columns());
  for (int j = rows.first; j <= rows.last; ++j) {
    int before = -2;
    const auto inside = [&](int i) {
      const bool same_run = i == before + 1;
      before = i;
      if (same_run) return false;
      const Vec2 corner = grid.corner(i, j), centre{corner.x + 0.5 * cell.x, corner.y + 0.5 * cell.y};
      if (!inside_ring(vertices, edges, centre)) return false;
      where = centre;
      return true;
    };
    if (any_occupied(grid, j, columns, inside)) return true;
  }
  return false;
}

}  // namespace irsim
