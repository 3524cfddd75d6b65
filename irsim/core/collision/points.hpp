// Broad phase for points: a grid that finds points near a place.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

/// Points stored in the cells of an unbounded square grid, which are hashed into buckets. Every stored point within
/// reach of a query is reported once, in no particular order. Points that are not finite are never found.
class Points {
 public:
  /// Store these points in cells of this size [m].
  void build(const std::vector<Vec2>& points, double cell);
  bool empty() const { return entries_.empty(); }

  /// Report the index of each point at most `reach` [m] away from `centre`.
  template <class Report>
  void query(Vec2 centre, double reach, Report&& report) const {
    const double reach2 = reach * reach;
    const double x0 = column(centre.x - reach), x1 = column(centre.x + reach);
    const double y0 = column(centre.y - reach), y1 = column(centre.y + reach);
    if (!((x1 - x0 + 1.0) * (y1 - y0 + 1.0) <= static_cast<double>(entries_.size()))) {  // more cells than points
      for (const Entry& entry : entries_) {
        if (squared(entry.point - centre) <= reach2) report(entry.index);
      }
      return;
    }
    for (double y = y0; y <= y1; y += 1.0) {
      for (double x = x0; x <= x1; x += 1.0) {
        const auto cx = static_cast<std::int32_t>(x), cy = static_cast<std::int32_t>(y);
        const std::size_t bucket = bucket_of(cx, cy);
        for (std::uint32_t k = start_[bucket]; k < start_[bucket + 1]; ++k) {
          const Entry& entry = entries_[k];
          if (entry.x == cx && entry.y == cy && squared(entry.point - centre) <= reach2) report(entry.index);
        }
      }
    }
  }

 private:
  struct Entry {
    Vec2 point;
    std::int32_t x, y;
    int index;
  };

  double column(double coordinate) const { return clip(std::floor(coordinate * inverse_), -1e9, 1e9); }
  std::size_t bucket_of(std::int32_t x, std::int32_t y) const {
    const std::uint32_t h = static_cast<std::uint32_t>(x) * 0x9E3779B1u ^ static_cast<std::uint32_t>(y) * 0x85EBCA77u;
    return (h ^ (h >> 15)) & mask_;
  }

  double inverse_ = 1.0;
  std::uint32_t mask_ = 0;
  std::vector<Entry> entries_, given_;
  std::vector<std::uint32_t> start_;
};

}  // namespace irsim
