#include "collision/grid.hpp"

namespace irsim {

void Grid::clear(double cell) {
  inverse_ = cell > 0.0 && std::isfinite(cell) ? 1.0 / cell : 1.0;
  items_.clear();
}

void Grid::add(int id, const Box& box) {
  if (box.finite()) items_.push_back({box, id});
}

void Grid::build() {
  if (items_.size() <= kMaxLinearItems) return;
  large_.clear();
  entries_.clear();
  for (std::size_t k = 0; k < items_.size(); ++k) {
    const Cells cells = covered(items_[k].box);
    if (cells.count() > kMaxCellsPerBox) {
      large_.push_back(items_[k]);
      continue;
    }
    for (std::int32_t y = cells.y0; y <= cells.y1; ++y)
      for (std::int32_t x = cells.x0; x <= cells.x1; ++x) entries_.push_back({x, y, static_cast<std::uint32_t>(k)});
  }
  std::uint32_t buckets = 1;
  while (buckets < entries_.size()) buckets *= 2;
  mask_ = buckets - 1;
  start_.assign(buckets + 1, 0);
  for (const Entry& e : entries_) ++start_[bucket_of(e.x, e.y)];
  std::uint32_t sum = 0;
  for (std::uint32_t& s : start_) s = sum += s;
  sorted_.resize(entries_.size());
  for (std::size_t k = entries_.size(); k-- > 0;) {
    const Entry& e = entries_[k];
    sorted_[--start_[bucket_of(e.x, e.y)]] = e;
  }
}

}  // namespace irsim
