#include "orca/nearest.hpp"

namespace irsim {

void Nearest::build() {
  start_.clear();
  if (points_.size() <= kMaxLinearPoints) return;
  Box box;
  double known = 0.0;
  for (const Vec2 p : points_) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) continue;
    box.include(p);
    known += 1.0;
  }
  if (known == 0.0) return;
  // Evenly spread points get about one cell each.
  const double width = box.x1 - box.x0, height = box.y1 - box.y0;
  cell_ = std::max({std::sqrt(width * height / known), (width + height) / known, 1e-9});
  inverse_ = 1.0 / cell_;
  x0_ = box.x0, y0_ = box.y0;
  columns_ = static_cast<int>(width * inverse_) + 1;
  rows_ = static_cast<int>(height * inverse_) + 1;
  const std::size_t count = static_cast<std::size_t>(columns_) * rows_;
  start_.assign(count + 1, 0);
  cells_.resize(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vec2 p = points_[i];
    const bool finite = std::isfinite(p.x) && std::isfinite(p.y);
    cells_[i] = finite ? static_cast<std::uint32_t>(column(p.y - y0_, rows_) * columns_ + column(p.x - x0_, columns_))
                       : UINT32_MAX;
    if (finite) ++start_[cells_[i] + 1];
  }
  for (std::size_t c = 0; c < count; ++c) start_[c + 1] += start_[c];
  entries_.resize(points_.size());
  for (std::size_t i = points_.size(); i-- > 0;) {
    if (cells_[i] == UINT32_MAX) continue;
    entries_[--start_[cells_[i] + 1]] = {points_[i], static_cast<int>(i)};
  }
  // start_[c + 1] has moved to the first entry of cell c
  for (std::size_t c = 0; c < count; ++c) start_[c] = start_[c + 1];
  start_[count] = static_cast<std::uint32_t>(known);
}

}  // namespace irsim
