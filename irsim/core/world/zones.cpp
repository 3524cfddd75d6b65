#include "world/zones.hpp"

namespace irsim {

Zones::Zones(const std::vector<Outline>& parts) {
  for (const Outline& part : parts) shapes.add({part}, true);
  outlines.resize(shapes.size[1]);
  for (int zone = 0; zone < count(); ++zone) outlines.place(shapes, zone, {}, {1.0, 0.0});
}

}  // namespace irsim
