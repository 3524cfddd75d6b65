#include "planning/space.hpp"

#include <algorithm>

#include "collision/distance.hpp"
#include "collision/touch.hpp"
#include "geometry/predicates.hpp"

namespace irsim {

bool Blockers::meet(const Footprint& body) const {
  bool met = false;
  grid.query(body.box, [&](int id) { met = met || (counts(id) && touch(body, outlines.footprint(shapes, id))); });
  if (met || others == nullptr) return met;
  return std::any_of(others->begin(), others->end(),
                     [&](const Footprint& other) { return body.box.meets(other.box) && touch(body, other); });
}

double Blockers::gap(const Footprint& body, double most) const {
  Box around = body.box;
  around.include(Vec2{body.box.x0 - most, body.box.y0 - most});
  around.include(Vec2{body.box.x1 + most, body.box.y1 + most});
  double least = most;
  grid.query(around, [&](int id) {
    if (counts(id)) least = std::min(least, distance(body, outlines.footprint(shapes, id)));
  });
  if (others == nullptr) return least;
  for (const Footprint& other : *others) {
    if (around.meets(other.box)) least = std::min(least, distance(body, other));
  }
  return least;
}

void Terrain::add(const std::vector<Outline>& outlines, const Pose& pose) {
  std::vector<Outline> closed;
  for (const Outline& outline : outlines) closed.push_back(closed_outline(outline));
  shapes_.add(closed, false);
  poses_.push_back(pose);
}

void Terrain::build() {
  outlines_.resize(shapes_.size[0]);
  std::vector<double> sizes;
  for (std::size_t k = 0; k < poses_.size(); ++k) {
    outlines_.place(shapes_, static_cast<int>(k), poses_[k], unit(poses_[k].theta));
    sizes.push_back(shapes_.radius[k]);
  }
  double cell = 1.0;
  if (!sizes.empty()) {
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    cell = std::max(3.0 * *middle, 1e-3);
  }
  grid_.clear(cell);
  for (std::size_t k = 0; k < poses_.size(); ++k) grid_.add(static_cast<int>(k), outlines_.boxes[k]);
  grid_.build();
}

bool Space::inside(Vec2 p) const {
  const double slack = 1e-9 * (1.0 + std::fabs(p.x) + std::fabs(p.y));
  const Box own = enclosed ? body.box() : Box{0.0, 0.0, 0.0, 0.0};
  return p.x + own.x0 >= bounds.x0 - slack && p.x + own.x1 <= bounds.x1 + slack && p.y + own.y0 >= bounds.y0 - slack &&
         p.y + own.y1 <= bounds.y1 + slack && (region == nullptr || region->holds(p));
}

Region::Region(const std::vector<std::vector<double>>& corners) {
  for (const std::vector<double>& corner : corners) ring_.push_back({corner[0], corner[1]});
  ring_.push_back(ring_.front());
}

bool Region::holds(Vec2 p) const { return inside_ring(ring_.data(), static_cast<int>(ring_.size()) - 1, p); }

Box Region::box() const {
  Box box;
  for (const Vec2 corner : ring_) box.include(corner);
  return box;
}

bool Region::keeps(Vec2 a, Vec2 b) const {
  int crossed = 0;
  Vec2 where;
  for (std::size_t k = 0; k + 1 < ring_.size(); ++k) crossed += segments_meet(a, b, ring_[k], ring_[k + 1], where);
  return crossed == 0 || (crossed == 1 && !holds(a) && holds(b));
}

}  // namespace irsim
