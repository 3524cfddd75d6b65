// Forces between objects that decide together: each pair is computed once.
#pragma once

#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

/// What objects of one decision exert on those that decide after them. Object k of the decision adds for later ones and
/// takes what earlier ones have added for it; both see others in the same order, so nothing is searched.
class MutualForces {
 public:
  /// Begin a decision of these objects, which are among `total`.
  void begin(const int* objects, int count, int total) {
    if (static_cast<int>(forces_.size()) < count) forces_.resize(count);
    place_.assign(total, -1);
    for (int k = 0; k < count; ++k) {
      place_[objects[k]] = k;
      forces_[k].clear();
    }
  }
  /// Object k of the decision is next.
  void decide(int k) { deciding_ = k, next_ = 0; }

  /// Whether an object decides later than the present one.
  bool later(int object) const { return place_[object] > deciding_; }
  /// Add what the object `from`, which decides now, exerts on an object that decides later.
  void add(int from, int on, Vec2 force) { forces_[place_[on]].push_back({from, force}); }

  /// What `from` exerts on the object that decides now; null if it is not known. Calls are by ascending `from`.
  const Vec2* find(int from) {
    const std::vector<Force>& known = forces_[deciding_];
    while (next_ < known.size() && known[next_].from < from) ++next_;
    return next_ < known.size() && known[next_].from == from ? &known[next_].force : nullptr;
  }

 private:
  struct Force {
    int from;
    Vec2 force;
  };
  std::vector<int> place_;                  // (total,) index in the decision; -1: the object does not decide in it
  std::vector<std::vector<Force>> forces_;  // (count,) by ascending `from`
  int deciding_ = 0;
  std::size_t next_ = 0;
};

}  // namespace irsim
