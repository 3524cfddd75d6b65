// Forces between objects that decide together: each pair is computed once.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/vec.hpp"
#include "sfm/social_force.hpp"

namespace irsim {

/// The forces that objects of one decision exert on one another. Object k of the decision takes what earlier ones have
/// added for it, and adds for later ones. All see others by ascending id, so nothing is searched.
class MutualForces {
 public:
  /// Begin a decision of these objects, which are among `total`.
  void begin(const int* objects, int count, int total) {
    if (static_cast<int>(forces_.size()) < count) forces_.resize(count);
    if (static_cast<int>(seen_.size()) < total) seen_.resize(total);
    place_.assign(total, -1);
    tied_.assign(count, 0);
    for (int k = 0; k < count; ++k) {
      place_[objects[k]] = k;
      forces_[k].clear();
    }
  }
  /// Object k of the decision is next. It calls `knows` for the others that it sees, by ascending id, and `expect` for
  /// the forces that it does not know; then `sum`.
  void decide(int k) { deciding_ = k, next_ = count_ = 0; }

  /// Whether the force of `from` is known; if so, it is taken.
  bool knows(int from) {
    const std::vector<Force>& known = forces_[deciding_];
    while (next_ < known.size() && known[next_].from < from) ++next_;
    if (next_ == known.size() || known[next_].from != from) return false;
    see(-1).known = known[next_].force;
    return true;
  }
  /// The force of `from` will be known at last. `centred`: whether the object sees `from` at its origin.
  void expect(int from, bool centred) { see(from).centred = centred; }

  /// The object that decides and `other` are mirror images of each other; `other` need not find out by itself.
  void tie(int other) {
    tied_[deciding_] = 1;
    if (place_[other] >= 0) tied_[place_[other]] = 1;
  }
  /// Whether the object that decides is a mirror image of another one.
  bool tied() const { return tied_[deciding_] != 0; }

  /// Sum of all forces in the order of the calls; `computed` are the expected ones. Forces that others need are kept.
  /// `centred`: whether others see the object, `self`, at its origin.
  Vec2 sum(int self, bool centred, const SocialForces& computed) {
    Vec2 sum;
    std::size_t k = 0;
    for (std::size_t s = 0; s < count_; ++s) {
      const Seen& seen = seen_[s];
      if (seen.from < 0) {
        sum = sum + seen.known;
        continue;
      }
      const Vec2 force = computed.force(k);
      sum = sum + force;
      if (centred && seen.centred && place_[seen.from] > deciding_ && computed.mutual(k)) {
        Force& kept = forces_[place_[seen.from]].emplace_back();
        kept.from = self, kept.force = force * -1.0;
      }
      ++k;
    }
    return sum;
  }

 private:
  struct Force {
    int from;
    Vec2 force;
  };
  struct Seen {
    Vec2 known;
    int from;  // -1: the force is known
    bool centred;
  };
  /// The fields are written one by one: a processor waits if it has to read back several of them as one.
  Seen& see(int from) {
    Seen& seen = seen_[count_++];
    seen.from = from;
    return seen;
  }

  std::vector<std::uint8_t> tied_;          // (count,)
  std::vector<int> place_;                  // (total,) index in the decision; -1: the object does not decide in it
  std::vector<std::vector<Force>> forces_;  // (count,) by ascending `from`
  std::vector<Seen> seen_;                  // in the order of the calls
  int deciding_ = 0;
  std::size_t next_ = 0, count_ = 0;
};

}  // namespace irsim
