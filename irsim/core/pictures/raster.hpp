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
  /// Set the part of the picture that may be covered. What was collected must have been swept before.
  void clip(PixelBox box);

  /// Add a directed edge; the edges of an outline must close it. x grows to the right, y downwards [px].
  void edge(Vec2 from, Vec2 to);

  /// Add a closed outline.
  void outline(const Vec2* points, std::size_t count);

  /// Call `cover(y, x, share)` for each covered pixel, with a share of 0..1, and forget the outlines.
  ///
  /// Where outlines in the same direction overlap, their shares are added up to 1.
  template <class Cover>
  void sweep(Cover&& cover) {
    for (int y = first_; y <= last_; ++y) {
      Row& row = rows_[y - box_.top];
      float* deltas = deltas_.data() + static_cast<std::size_t>(y - box_.top) * pitch_;
      float sum = 0.0f;
      for (int x = row.from; x <= row.to; ++x) {
        sum += deltas[x];
        deltas[x] = 0.0f;
        const float share = std::min(std::fabs(sum), 1.0f);
        if (share > kLeastShare && x < box_.right - box_.left) cover(y, box_.left + x, share);
      }
      row = {};
    }
    first_ = box_.bottom;
    last_ = box_.top - 1;
  }

  /// The rows that have been touched; empty if `bottom <= top`.
  PixelBox touched() const;

 private:
  static constexpr float kLeastShare = 1.0f / 512.0f;
  struct Row {
    int from = 1 << 30, to = -1;
  };

  void inner_edge(double x0, double y0, double x1, double y1);
  void part(Row& row, float* deltas, double x0, double x1, float height);

  PixelBox box_;
  std::size_t pitch_ = 0;
  int first_ = 0, last_ = -1;
  std::vector<float> deltas_;  ///< per pixel, the change of the covered share from its left neighbor
  std::vector<Row> rows_;
};

}  // namespace irsim
