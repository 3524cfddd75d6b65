// The k nearest of many points.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

/// Whether a is farther to the right of a direction than b, or else farther ahead; `same` if they are one point.
inline bool is_right_of(Vec2 a, Vec2 b, Vec2 ahead, bool same) {
  const double side_a = cross(ahead, a), side_b = cross(ahead, b), way_a = dot(ahead, a), way_b = dot(ahead, b);
  if (side_a != side_b) return side_a < side_b;
  return way_a != way_b ? way_a > way_b : same;
}

/// Points of the plane, stored in a grid if there are many. Points that are not finite are never found.
class Nearest {
 public:
  struct Found {
    double distance2;  // [m2]
    int index;
  };

  /// Remove all points. Then `add` points and `build`.
  void clear() { points_.clear(); }
  void add(Vec2 point) { points_.push_back(point); }
  void build();

  /// Find up to `most` points less than `reach` [m] away from `centre` for which `seen(index)` holds, nearest first.
  /// Points that are equally far come from the right to the left of `ahead`, so that their indices do not matter unless
  /// they are the same point. Returns their number; `found` must have space for `most`. `likely`: distinct indices of
  /// points that may be among them, such as those found in the step before; they save time and do not change the
  /// result.
  template <class Seen>
  int find(Vec2 centre, Vec2 ahead, double reach, int most, const std::vector<int>& likely, Seen&& seen,
           Found* found) const {
    if (most <= 0) return 0;
    Best best{points_.data(), ahead, found, most, 0, reach * reach};
    if (start_.empty()) {
      if (points_.size() > kMaxLinearPoints) return 0;  // `build` made no grid, because none of them is finite
      const double farthest2 = farthest(centre, most, likely, seen), limit2 = std::min(best.limit2, farthest2);
      int candidates[kMaxLinearPoints + 1];
      int count = 0;
      for (int i = 0; i < static_cast<int>(points_.size()); ++i) {  // without a branch that cannot be predicted
        candidates[count] = i;
        count += squared(points_[i] - centre) <= limit2;
      }
      int kept = 0;
      for (int k = 0; k < count; ++k) {
        if (seen(candidates[k])) candidates[kept++] = candidates[k];
      }
      // Usually these are the likely ones, whose order has hardly changed.
      const int* offered = kept == most && farthest2 <= best.limit2 ? likely.data() : candidates;
      for (int k = 0; k < kept; ++k) {
        const double distance2 = squared(points_[offered[k]] - centre);
        if (distance2 <= best.limit2) best.offer({distance2, offered[k]});
      }
      return best.count;
    }
    const int cx = column(centre.x - x0_, columns_), cy = column(centre.y - y0_, rows_);
    const int rings = std::max(std::max(cx, columns_ - 1 - cx), std::max(cy, rows_ - 1 - cy));
    for (int ring = 0; ring <= rings; ++ring) {
      const double gap = (ring - 1) * cell_;  // lower bound of the distance of points in this ring
      if (ring > 1 && gap * gap > best.limit2) break;
      for (int y = std::max(cy - ring, 0); y <= std::min(cy + ring, rows_ - 1); ++y) {
        const bool whole = y == cy - ring || y == cy + ring;
        const int stride = whole || ring == 0 ? 1 : 2 * ring;
        for (int x = cx - ring; x <= cx + ring; x += stride) {
          if (x < 0 || x >= columns_) continue;
          const std::size_t cell = static_cast<std::size_t>(y) * columns_ + x;
          for (std::uint32_t k = start_[cell]; k < start_[cell + 1]; ++k) {
            const double distance2 = squared(entries_[k].point - centre);
            if (distance2 <= best.limit2 && seen(entries_[k].index)) best.offer({distance2, entries_[k].index});
          }
        }
      }
    }
    return best.count;
  }

 private:
  static constexpr std::size_t kMaxLinearPoints = 64;  // up to this many points are searched one by one

  /// The nearest points so far, sorted.
  struct Best {
    const Vec2* points;
    Vec2 ahead;
    Found* found;
    int most, count;
    double limit2;  // points farther away than this are not needed

    bool first(const Found& a, const Found& b) const {
      if (a.distance2 != b.distance2) return a.distance2 < b.distance2;
      return is_right_of(points[a.index], points[b.index], ahead, a.index < b.index);
    }
    void offer(Found next) {
      if (count == most) {
        if (!first(next, found[count - 1])) return;
      } else {
        if (!(next.distance2 < limit2)) return;
        ++count;
      }
      int k = count - 1;
      for (; k > 0 && first(next, found[k - 1]); --k) found[k] = found[k - 1];
      found[k] = next;
      if (count == most) limit2 = found[count - 1].distance2;
    }
  };
  struct Entry {
    Vec2 point;
    int index;
  };

  /// Square of a distance within which there are at least `most` points; infinite if `likely` are too few to tell.
  template <class Seen>
  double farthest(Vec2 centre, int most, const std::vector<int>& likely, Seen&& seen) const {
    if (static_cast<int>(likely.size()) < most) return kInfinity;
    double farthest2 = 0.0;
    for (int k = 0; k < most; ++k) {
      const double distance2 = squared(points_[likely[k]] - centre);
      if (!(distance2 < kInfinity) || !seen(likely[k])) return kInfinity;
      farthest2 = std::max(farthest2, distance2);
    }
    return farthest2;
  }

  int column(double offset, int count) const {
    return static_cast<int>(clip(std::floor(offset * inverse_), 0.0, count - 1.0));
  }

  std::vector<Vec2> points_;
  double x0_ = 0, y0_ = 0, cell_ = 1, inverse_ = 1;
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> start_, cells_;
  std::vector<Entry> entries_;
};

}  // namespace irsim
