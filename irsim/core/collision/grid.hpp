// Broad phase: a grid that finds boxes which may meet.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

/// Boxes stored in the cells of an unbounded square grid that they cover; cells are hashed into buckets. Every stored
/// box that meets a query is reported once, in no particular order. Boxes that are not finite meet nothing.
class Grid {
 public:
  /// Remove all boxes and set the cell size, which should be about the size of the boxes.
  void clear(double cell);
  void add(int id, const Box& box);
  /// Sort the boxes that were added; queries are possible afterwards.
  void build();

  /// Call `fetch` with the array that a query reads first.
  template <class Fetch>
  void fetch(Fetch&& fetch) const {
    fetch(items_);
  }

  template <class Report>
  void query(const Box& box, Report&& report) const {
    if (!box.finite()) return;
    if (items_.size() <= kMaxLinearItems) {
      for (const Item& item : items_)
        if (item.box.meets(box)) report(item.id);
      return;
    }
    const Cells cells = covered(box);
    if (cells.count() > kMaxCellsPerBox) {
      for (const Item& item : items_)
        if (item.box.meets(box)) report(item.id);
      return;
    }
    for (const Item& item : large_)
      if (item.box.meets(box)) report(item.id);
    if (entries_.empty()) return;
    for (std::int32_t y = cells.y0; y <= cells.y1; ++y) {
      for (std::int32_t x = cells.x0; x <= cells.x1; ++x) {
        const std::size_t bucket = bucket_of(x, y);
        for (std::uint32_t k = start_[bucket]; k < start_[bucket + 1]; ++k) {
          const Entry& entry = sorted_[k];
          if (entry.x != x || entry.y != y) continue;
          const Item& item = items_[entry.item];
          // Two boxes may share several cells. Only the cell with the lower left corner of their overlap reports them.
          if (item.box.meets(box) && column(std::max(item.box.x0, box.x0)) == x &&
              column(std::max(item.box.y0, box.y0)) == y) {
            report(item.id);
          }
        }
      }
    }
  }

 private:
  static constexpr std::int64_t kMaxCellsPerBox = 64;  // boxes that cover more cells are kept in a list
  static constexpr std::size_t kMaxLinearItems = 16;   // up to this many boxes are tested one by one, without cells
  struct Cells {
    std::int32_t x0, y0, x1, y1;
    std::int64_t count() const { return (std::int64_t{x1} - x0 + 1) * (std::int64_t{y1} - y0 + 1); }
  };
  struct Item {
    Box box;
    int id;
  };
  struct Entry {
    std::int32_t x, y;
    std::uint32_t item;
  };

  std::int32_t column(double coordinate) const {
    return static_cast<std::int32_t>(clip(std::floor(coordinate * inverse_), -1e9, 1e9));
  }
  Cells covered(const Box& box) const { return {column(box.x0), column(box.y0), column(box.x1), column(box.y1)}; }
  std::size_t bucket_of(std::int32_t x, std::int32_t y) const {
    const std::uint32_t h = static_cast<std::uint32_t>(x) * 0x9E3779B1u ^ static_cast<std::uint32_t>(y) * 0x85EBCA77u;
    return (h ^ (h >> 15)) & mask_;
  }

  double inverse_ = 1.0;
  std::uint32_t mask_ = 0;
  std::vector<Item> items_, large_;
  std::vector<Entry> entries_, sorted_;
  std::vector<std::uint32_t> start_;
};

}  // namespace irsim
