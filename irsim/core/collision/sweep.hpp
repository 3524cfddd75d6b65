// Broad phase among moving objects: sort and sweep along one axis.
#pragma once

#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

/// Keeps the order of the last step, so that sorting costs little. Every pair of boxes that meet is reported once, in
/// no particular order. Boxes that are not finite meet nothing.
class Sweep {
 public:
  /// Start over with objects `ids`.
  void reset(const std::vector<int>& ids);

  /// Report the ids of each pair of boxes that meet; `box(id)` returns the present box.
  template <class Boxes, class Report>
  void pairs(Boxes&& box, Report&& report) {
    for (Entry& entry : entries_) entry.box = box(entry.id);
    sort();
    for (auto a = entries_.begin(); a != entries_.end(); ++a) {
      const double end = upright_ ? a->box.y1 : a->box.x1;
      for (auto b = a + 1; b != entries_.end() && b->key <= end; ++b) {
        if (a->box.meets(b->box)) report(a->id, b->id);
      }
    }
  }

  /// Call a function with everything that is remembered from step to step.
  template <class Visit>
  void visit(Visit&& visit) {
    visit(entries_, upright_);
  }

 private:
  struct Entry {
    double key;
    Box box;
    int id;
  };
  void sort();

  std::vector<Entry> entries_;
  bool upright_ = false;  // whether entries are sorted along y
};

}  // namespace irsim
