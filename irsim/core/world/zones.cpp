#include "world/zones.hpp"

#include <stdexcept>
#include <utility>

#include "geometry/predicates.hpp"

namespace irsim {

Zones::Zones(const std::vector<Outline>& parts, std::vector<Ground> given) : grounds(std::move(given)) {
  for (const Outline& part : parts) shapes.add({part}, true);
  outlines.resize(shapes.size[1]);
  for (int zone = 0; zone < count(); ++zone) outlines.place(shapes, zone, {}, {1.0, 0.0});
  for (const Ground& ground : grounds) {
    if (ground.zone < 0 || ground.zone >= count()) throw std::invalid_argument("a ground is of a zone that is missing");
  }
}

bool Zones::covers(int zone, Vec2 at) const {
  const Footprint area = footprint(zone);
  const Part& part = area.parts[0];
  if (part.kind == Kind::circle) return squared(at - *area.vertices) <= part.radius * part.radius;
  return part.kind == Kind::polygon && inside_ring(area.vertices + part.first, part.last - part.first, at);
}

const Ground* Zones::ground_at(Vec2 at) const {
  for (std::size_t k = grounds.size(); k-- > 0;) {
    if (covers(grounds[k].zone, at)) return &grounds[k];
  }
  return nullptr;
}

}  // namespace irsim
