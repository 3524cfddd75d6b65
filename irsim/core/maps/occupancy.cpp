#include "maps/occupancy.hpp"

#include <algorithm>
#include <stdexcept>

namespace irsim {
namespace {

constexpr int kFar = 255;  // largest side of a free square [cells]

/// A corner of the grid, counted row by row.
using Corner = std::int64_t;

/// A straight piece of the outline with the occupied side on its left. Directions: 0 +x, 1 +y, 2 -x, 3 -y.
struct Run {
  Corner from, to;
  int direction;
  bool used;
};

}  // namespace

OccupancyGrid::OccupancyGrid(int columns, int rows, Vec2 origin, Vec2 cell, const std::vector<std::uint8_t>& occupied,
                             const std::vector<std::uint8_t>& unknown)
    : columns_(columns), rows_(rows), origin_(origin), cell_(cell) {
  const std::size_t cells =
      static_cast<std::size_t>(std::max(columns, 0)) * static_cast<std::size_t>(std::max(rows, 0));
  if (columns < 1 || rows < 1 || occupied.size() != cells)
    throw std::invalid_argument("an occupancy grid needs at least one cell");
  if (!(cell.x > 0.0 && cell.y > 0.0 && std::isfinite(cell.x) && std::isfinite(cell.y)))
    throw std::invalid_argument("cells must have a positive size");
  for (int j = 0; j < rows; ++j) {
    int least = columns, most = -1;
    for (int i = 0; i < columns; ++i) {
      if (occupied[at(i, j)] == 0) continue;
      ++count_;
      least = std::min(least, i), most = i;
    }
    if (most >= 0) bounds_.include(box(least, j)), bounds_.include(box(most, j));
  }
  for (std::vector<std::uint8_t>& squares : free_) squares.resize(cells);
  // Each row follows from the row before it. Squares to the left and to the right are computed together, which is
  // faster, because neither depends on the other.
  const std::vector<std::uint8_t> beyond(static_cast<std::size_t>(columns), kFar);
  for (const int down : {0, 1}) {
    const std::uint8_t *right_ahead = beyond.data(), *left_ahead = beyond.data();
    for (int row = 0; row < rows; ++row) {
      const std::size_t first = at(0, down ? row : rows - 1 - row);
      const std::uint8_t* full = occupied.data() + first;
      std::uint8_t *right = free_[2 * down].data() + first, *left = free_[2 * down + 1].data() + first;
      int right_next = kFar, right_corner = kFar, left_next = kFar, left_corner = kFar;
      const auto square = [&](bool is_full, int& next, int& corner, int ahead) {
        const int least = std::min(next, std::min(corner, std::min(ahead, kFar - 1))) + 1;
        corner = ahead, next = is_full ? 0 : least;
        return static_cast<std::uint8_t>(next);
      };
      for (int i = 0, k = columns - 1; k >= 0; ++i, --k) {
        right[k] = square(full[k] != 0, right_next, right_corner, right_ahead[k]);
        left[i] = square(full[i] != 0, left_next, left_corner, left_ahead[i]);
      }
      right_ahead = right, left_ahead = left;
    }
  }
  if (unknown.size() != cells) return;
  std::vector<std::uint8_t> closed = occupied;
  bool all_known = true;
  for (std::size_t k = 0; k < cells; ++k) {
    if (unknown[k] != 0 && occupied[k] == 0) closed[k] = 1, all_known = false;
  }
  if (!all_known) closed_ = std::make_shared<const OccupancyGrid>(columns, rows, origin, cell, closed);
}

bool OccupancyGrid::on_outline(int i, int j) const {
  const int full = occupied(i - 1, j - 1) + occupied(i, j - 1) + occupied(i - 1, j) + occupied(i, j);
  return full > 0 && full < 4;
}

bool OccupancyGrid::clear_of(Vec2 point, double reach) const {
  const double x = (point.x - origin_.x) / cell_.x, y = (point.y - origin_.y) / cell_.y;
  if (!(x >= 0.0 && y >= 0.0 && x < columns_ && y < rows_)) return false;
  // cells up to one less than the clearance away are free, and the point may be at the edge of its own
  return reach < (clearance(static_cast<int>(x), static_cast<int>(y)) - 1) * std::min(cell_.x, cell_.y) * (1.0 - 1e-9);
}

std::vector<std::vector<Vec2>> OccupancyGrid::outline() const {
  const Corner width = columns_ + 1;
  std::vector<Run> runs;
  const auto add = [&](Corner low, Corner high, bool forward, int axis) {
    runs.push_back({forward ? low : high, forward ? high : low, forward ? axis : axis + 2, false});
  };
  // side: 1 occupied on the left of the increasing direction only, -1 on the right only, 0 both or neither
  const auto trace = [&](int lines, int length, int axis, auto&& side, auto&& corner) {
    for (int line = 0; line <= lines; ++line) {
      int began = 0, last = 0;
      for (int k = 0; k <= length; ++k) {
        const int now = k < length ? side(line, k) : 0;
        if (now == last) continue;
        if (last != 0) add(corner(line, began), corner(line, k), last > 0, axis);
        began = k, last = now;
      }
    }
  };
  trace(
      rows_, columns_, 0,
      [&](int j, int i) { return static_cast<int>(occupied(i, j)) - static_cast<int>(occupied(i, j - 1)); },
      [&](int j, int i) { return j * width + i; });
  trace(
      columns_, rows_, 1,
      [&](int i, int j) { return static_cast<int>(occupied(i - 1, j)) - static_cast<int>(occupied(i, j)); },
      [&](int i, int j) { return j * width + i; });

  std::vector<std::pair<Corner, int>> starts;
  starts.reserve(runs.size());
  for (std::size_t k = 0; k < runs.size(); ++k) starts.emplace_back(runs[k].from, static_cast<int>(k));
  std::sort(starts.begin(), starts.end());
  // Of the runs that leave a corner, the left turn stays with the same cell.
  const auto next = [&](const Run& run) {
    int found = -1;
    for (auto s = std::lower_bound(starts.begin(), starts.end(), std::make_pair(run.to, 0));
         s != starts.end() && s->first == run.to; ++s) {
      if (runs[s->second].used) continue;
      if (found < 0 || runs[s->second].direction == (run.direction + 1) % 4) found = s->second;
    }
    return found;
  };
  std::vector<std::vector<Vec2>> rings;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (runs[k].used) continue;
    std::vector<Vec2> ring;
    for (int r = static_cast<int>(k); r >= 0; r = next(runs[r])) {
      runs[r].used = true;
      ring.push_back(corner(static_cast<int>(runs[r].from % width), static_cast<int>(runs[r].from / width)));
    }
    rings.push_back(std::move(ring));
  }
  return rings;
}

}  // namespace irsim
