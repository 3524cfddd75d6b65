#include "collision/sweep.hpp"

namespace irsim {

void Sweep::reset(const std::vector<int>& ids) {
  entries_.clear();
  for (const int id : ids) entries_.push_back({0.0, {}, id});
  upright_ = false;
}

void Sweep::sort() {
  Box all;
  for (Entry& entry : entries_) {
    if (entry.box.finite()) {
      all.include(entry.box);
    } else {
      entry.box = {};  // an empty box meets nothing and is sorted to the end
    }
  }
  const double width = all.x1 - all.x0, height = all.y1 - all.y0;
  const bool turned = upright_ ? width > 2.0 * height : height > 2.0 * width;
  if (turned) upright_ = !upright_;
  for (Entry& entry : entries_) entry.key = upright_ ? entry.box.y0 : entry.box.x0;
  const auto before = [](const Entry& a, const Entry& b) { return a.key < b.key; };
  if (turned) std::sort(entries_.begin(), entries_.end(), before);
  std::size_t moves = 0;
  for (std::size_t i = 1; i < entries_.size(); ++i) {
    if (!before(entries_[i], entries_[i - 1])) continue;
    const Entry entry = entries_[i];
    std::size_t k = i;
    for (; k > 0 && before(entry, entries_[k - 1]); --k) entries_[k] = entries_[k - 1];
    entries_[k] = entry;
    moves += i - k;
    if (moves > 8 * entries_.size()) {  // a full sort is faster than many moves
      std::sort(entries_.begin(), entries_.end(), before);
      return;
    }
  }
}

}  // namespace irsim
