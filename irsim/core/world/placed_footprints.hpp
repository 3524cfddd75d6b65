// Footprints at places that were found for them one after the other, and whether another one fits among them.
#pragma once

#include <utility>
#include <vector>

#include "collision/distance.hpp"
#include "collision/grid.hpp"
#include "collision/touch.hpp"
#include "world/world.hpp"

namespace irsim {

/// A grid that answers queries while boxes are added.
class GrowingGrid {
 public:
  explicit GrowingGrid(double cell) {
    grid_.clear(cell);
    grid_.build();
  }
  void add(int id, const Box& box) {
    recent_.push_back({id, box});
    if (recent_.size() < 16 + built_ / 2) return;
    for (const auto& [one, its_box] : recent_) grid_.add(one, its_box);
    grid_.build();
    built_ += recent_.size();
    recent_.clear();
  }
  /// Whether `test` holds for one of the boxes that meet `box`.
  template <class Test>
  bool any(const Box& box, Test&& test) const {
    for (const auto& [id, other] : recent_) {
      if (other.meets(box) && test(id)) return true;
    }
    bool found = false;
    grid_.query(box, [&](int id) { found = found || test(id); });
    return found;
  }

 private:
  Grid grid_;
  std::vector<std::pair<int, Box>> recent_;  // boxes that are not in the grid yet
  std::size_t built_ = 0;
};

/// Footprints that must not overlap. Objects that are `unobstructed` fit everywhere and block no place.
class PlacedFootprints {
 public:
  PlacedFootprints(const World& world, const Shapes& shapes)
      : world_(world), shapes_(shapes), grid_(world.cell(shapes, world.visible)) {
    outlines_[0].resize(shapes.size[0]);
    outlines_[1].resize(shapes.size[1]);
  }
  /// Whether the object fits at a pose, where its outline then stays.
  bool fits(int object, const Pose& pose) {
    return fits(object, pose, [](int) { return false; });
  }
  /// The same, where it may overlap the objects for which `ignored` holds.
  template <class Ignored>
  bool fits(int object, const Pose& pose, Ignored&& ignored) {
    if (world_.unobstructed[object]) return true;
    place(object, pose);
    const Footprint body = footprint(object);
    return !grid_.any(body.box, [&](int other) { return !ignored(other) && touch(body, footprint(other)); });
  }
  /// Whether the object fits at a pose with at least this distance [m] to all others.
  bool is_clear(int object, const Pose& pose, double clearance) {
    if (world_.unobstructed[object]) return true;
    place(object, pose);
    const Footprint body = footprint(object);
    const Box& box = body.box;
    return !grid_.any({box.x0 - clearance, box.y0 - clearance, box.x1 + clearance, box.y1 + clearance}, [&](int other) {
      const Footprint there = footprint(other);
      return touch(body, there) || distance(body, there) < clearance;
    });
  }
  /// Whether the object, at a pose, meets an area that nothing may enter.
  bool meets(int object, const Pose& pose, const Footprint& area) {
    place(object, pose);
    const Footprint body = footprint(object);
    return body.box.meets(area.box) && touch(body, area);
  }
  void add(int object, const Pose& pose) {
    if (world_.unobstructed[object]) return;
    place(object, pose);
    grid_.add(object, footprint(object).box);
  }
  /// The objects that overlap an added one at its place.
  std::vector<int> overlapping(int object) {
    std::vector<int> found;
    if (world_.unobstructed[object]) return found;
    const Footprint body = footprint(object);
    grid_.any(body.box, [&](int other) {
      if (other != object && touch(body, footprint(other))) found.push_back(other);
      return false;
    });
    return found;
  }

 private:
  Outlines& outlines(int object) { return outlines_[world_.is_static[object]]; }
  Footprint footprint(int object) { return outlines(object).footprint(shapes_, object); }
  void place(int object, const Pose& pose) { outlines(object).place(shapes_, object, pose, unit(pose.theta)); }

  const World& world_;
  const Shapes& shapes_;
  Outlines outlines_[2];  // moving, static
  GrowingGrid grid_;
};

}  // namespace irsim
