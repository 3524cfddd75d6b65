#include "surroundings/bounding_circles.hpp"

#include <algorithm>

#include "world/state.hpp"
#include "world/world.hpp"

namespace irsim {
namespace {

/// Whether a static object counts as one thing at one place.
bool is_compact(const World& world, const Shapes& shapes, int object) {
  const Kind kind = shapes.parts[shapes.body[object].part].kind;
  return !world.unobstructed[object] && kind != Kind::cells && kind != Kind::room;
}

}  // namespace

void bounding_circles(const World& world, const State& state, int w, std::vector<BoundingCircle>& out) {
  const Shapes& shapes = *state.scenes[w].shapes;
  out.resize(world.objects);
  for (int i = 0; i < world.objects; ++i) {
    const int row = w * world.objects + i;
    const Vec2 offset = rotate(shapes.centre[i], state.heading(row));
    out[i] = {state.pose[row].position() + offset, shapes.radius[i]};
  }
}

void nearest_objects(const World& world, const State& state, const std::vector<BoundingCircle>& circles, int row,
                     int most, double reach, bool statics, NearestRows& out) {
  const std::size_t room = std::min(std::max(most, 0), world.objects);
  std::size_t count = 0;
  out.object.resize(room);
  out.gap.resize(room);
  if (room == 0) return;
  const int w = row / world.objects, self = row % world.objects;
  const int roles = world.target_roles[self];
  const Shapes& shapes = *state.scenes[w].shapes;
  const BoundingCircle& own = circles[self];
  for (int i = 0; i < world.objects; ++i) {
    if (i == self || !has_role(world, roles, i)) continue;
    if (world.is_static[i] && !(statics && is_compact(world, shapes, i))) continue;
    const BoundingCircle& other = circles[i];
    const double gap = norm(other.centre - own.centre) - other.radius - own.radius;
    const bool full = count == room;
    if (!(gap <= reach) || (full && gap >= out.gap[count - 1])) continue;
    std::size_t place = full ? count - 1 : count++;
    for (; place > 0 && out.gap[place - 1] > gap; --place) {  // equal gaps keep the order of indices
      out.gap[place] = out.gap[place - 1], out.object[place] = out.object[place - 1];
    }
    out.gap[place] = gap, out.object[place] = i;
  }
  out.object.resize(count);
  out.gap.resize(count);
}

}  // namespace irsim
