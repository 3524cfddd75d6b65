#include "collision/points.hpp"

namespace irsim {

void Points::build(const std::vector<Vec2>& points, double cell) {
  inverse_ = cell > 0.0 && std::isfinite(cell) ? 1.0 / cell : 1.0;
  given_.clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 p = points[i];
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) continue;
    given_.push_back(
        {p, static_cast<std::int32_t>(column(p.x)), static_cast<std::int32_t>(column(p.y)), static_cast<int>(i)});
  }
  std::uint32_t buckets = 1;
  while (buckets < 2 * given_.size()) buckets *= 2;
  mask_ = buckets - 1;
  start_.assign(buckets + 1, 0);
  for (const Entry& e : given_) ++start_[bucket_of(e.x, e.y)];
  std::uint32_t sum = 0;
  for (std::uint32_t& s : start_) s = sum += s;
  entries_.resize(given_.size());
  for (std::size_t k = given_.size(); k-- > 0;) entries_[--start_[bucket_of(given_[k].x, given_[k].y)]] = given_[k];
}

}  // namespace irsim
