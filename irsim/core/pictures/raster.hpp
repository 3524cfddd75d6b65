// Covers pixels by areas: the share of each pixel that lies inside is exact, as in Agg, which draws for Matplotlib.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/vec.hpp"
#include "pictures/pixels.hpp"

namespace irsim {

/// Collects the edges of closed outlines, which may overlap, and then visits the pixels that they cover.
///
/// The memory of the last picture is used again: only the rows that are touched are read and cleared.
class Raster {
 public:
  /// Set the part of the picture that may be covered. Collected edges must have been swept before.
  void clip(PixelBox box);

  /// Add a directed edge; the edges of an outline must close it. x grows to the right, y downwards [px].
  void edge(Vec2 from, Vec2 to) {
    const double high = box_.bottom - box_.top, wide = box_.right - box_.left;
    const double x0 = from.x - box_.left, y0 = from.y - box_.top, x1 = to.x - box_.left, y1 = to.y - box_.top;
    // Most edges lie in the box; comparisons with what is not a number are false.
    const bool inside =
        x0 >= 0.0 && x0 <= wide && x1 >= 0.0 && x1 <= wide && y0 >= 0.0 && y0 <= high && y1 >= 0.0 && y1 <= high;
    if (!inside) return cut_edge(from, to);
    if (y0 != y1) inner_edge(x0, y0, x1, y1);
  }

  /// Add a closed outline.
  void outline(const Vec2* points, std::size_t count);

  /// Call `cover(y, x, share)` for each covered pixel, with a share of 0..1, and forget the outlines.
  ///
  /// Where outlines in the same direction overlap, their shares are added up to 1.
  template <class Cover>
  void sweep(Cover&& cover) {
    for (int y = first_; y <= last_; ++y) {
      Row& row = rows_[y - box_.top];
      sweep_row(row, deltas_.data() + static_cast<std::size_t>(y - box_.top) * pitch_, y, cover);
      row = {};
    }
    first_ = box_.bottom;
    last_ = box_.top - 1;
  }

  /// Visit the pixels of one convex outline at once, without collecting it; what was collected stays.
  ///
  /// Returns false, and visits nothing, if the outline reaches beyond the left or right border of the box.
  template <class Cover>
  bool sweep_convex(const Vec2* points, std::size_t count, Cover&& cover) {
    if (!read_convex(points, count)) return false;
    for (int y = convex_.top; y < convex_.bottom; ++y) {
      Row row;
      for (const Side& side : sides_) {
        const double from = std::max(side.y0, static_cast<double>(y)), to = std::min(side.y1, y + 1.0);
        if (from >= to) continue;
        part(row, line_.data(), side.x0 + (from - side.y0) * side.slope, side.x0 + (to - side.y0) * side.slope,
             side.direction * static_cast<float>(to - from));
      }
      sweep_row(row, line_.data(), box_.top + y, cover);
    }
    return true;
  }

  /// The part that has been touched; empty if `bottom <= top`.
  PixelBox touched() const { return touched(first_, last_); }

  /// Append boxes around what has been touched, one for each band of rows.
  void add_touched(std::vector<PixelBox>& boxes) const;

 private:
  static constexpr float kLeastShare = 1.0f / 512.0f;
  struct Row {
    int from = 1 << 30, to = -1;
  };

  /// A side of a convex outline, downwards.
  struct Side {
    double x0, y0, y1, slope;
    float direction;
  };

  template <class Cover>
  void sweep_row(const Row& row, float* deltas, int y, Cover& cover) {
    const int left = box_.left, last = std::min(row.to, box_.right - left - 1);
    float sum = 0.0f;
    for (int x = row.from; x <= last; ++x) {
      sum += deltas[x];
      deltas[x] = 0.0f;
      const float share = std::min(std::fabs(sum), 1.0f);
      if (share > kLeastShare) cover(y, left + x, share);
    }
    for (int x = std::max(row.from, last + 1); x <= row.to; ++x) deltas[x] = 0.0f;
  }

  PixelBox touched(int first, int last) const;
  bool read_convex(const Vec2* points, std::size_t count);
  void cut_edge(Vec2 from, Vec2 to);
  void inner_edge(double x0, double y0, double x1, double y1);
  void part(Row& row, float* deltas, double x0, double x1, float height);

  PixelBox box_;
  std::size_t pitch_ = 0;
  int first_ = 0, last_ = -1;
  std::vector<float> deltas_;  ///< per pixel, the change of the covered share from its left neighbor
  std::vector<Row> rows_;
  std::vector<float> line_;  ///< the same for one row of a convex outline
  std::vector<Side> sides_;
  PixelBox convex_;  ///< its rows, from the upper border of the box
};

/// Add the part of an edge within one row: it ranges over `height` of the row, from x0 to x1, which lie in the box.
inline void Raster::part(Row& row, float* deltas, double x0, double x1, float height) {
  const double low = std::min(x0, x1), high = std::max(x0, x1);
  x0 = low, x1 = high;
  const int left = static_cast<int>(x0), right = static_cast<int>(x1);
  row.from = std::min(row.from, left);
  row.to = std::max(row.to, right + 1);
  deltas += left;
  const float start = static_cast<float>(x0 - left), end = static_cast<float>(x1 - right);
  if (left == right) {
    const float outside = height * 0.5f * (start + end);
    deltas[0] += height - outside;
    deltas[1] += outside;
    return;
  }
  const float per_column = height / static_cast<float>(x1 - x0), first = 1.0f - start;
  float covered = 0.5f * first * first * per_column, before = covered;
  *deltas++ += covered;
  for (int columns = right - left, k = 1; k < columns; ++k) {
    covered = (first + static_cast<float>(k - 1) + 0.5f) * per_column;
    *deltas++ += covered - before;
    before = covered;
  }
  // In the last column the edge ends after `end`; beyond it, the whole height is covered.
  covered = height * (1.0f - end) + end * (first + static_cast<float>(right - left - 1) + 0.5f * end) * per_column;
  deltas[0] += covered - before;
  deltas[1] += height - covered;
}

}  // namespace irsim
