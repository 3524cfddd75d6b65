#include "surroundings/bounding_circles.hpp"

#include <algorithm>
#include <utility>

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

std::vector<BoundingCircle> bounding_circles(const World& world, const State& state) {
  std::vector<BoundingCircle> circles(state.rows);
  for (int row = 0; row < state.rows; ++row) {
    const Shapes& shapes = *state.scenes[row / world.objects].shapes;
    const int object = row % world.objects;
    const Vec2 offset = rotate(shapes.centre[object], state.heading(row));
    circles[row] = {state.pose[row].position() + offset, shapes.radius[object]};
  }
  return circles;
}

std::vector<std::int32_t> nearest_objects(const World& world, const State& state,
                                          const std::vector<BoundingCircle>& circles, const std::int64_t* rows,
                                          std::size_t count, int most, double reach, bool statics) {
  std::vector<std::int32_t> out(count * static_cast<std::size_t>(most), -1);
  if (most == 0) return out;
  std::vector<std::pair<double, int>> found;  // the nearest so far
  const auto full = [&](const auto& list) { return list.size() == static_cast<std::size_t>(most); };
  for (std::size_t k = 0; k < count; ++k) {
    const int row = static_cast<int>(rows[k]), w = row / world.objects, self = row % world.objects;
    const int first = w * world.objects, roles = world.target_roles[self];
    const Shapes& shapes = *state.scenes[w].shapes;
    const BoundingCircle& own = circles[row];
    found.clear();
    for (int i = 0; i < world.objects; ++i) {
      if (i == self || (roles != 0 && (roles == 1) != (world.is_robot[i] != 0))) continue;
      if (world.is_static[i] && !(statics && is_compact(world, shapes, i))) continue;
      const BoundingCircle& other = circles[first + i];
      const double gap = norm(other.centre - own.centre) - other.radius - own.radius;
      if (!(gap <= reach) || (full(found) && gap >= found.back().first)) continue;
      if (full(found)) found.pop_back();
      const std::pair<double, int> one{gap, i};
      found.insert(std::upper_bound(found.begin(), found.end(), one), one);
    }
    for (std::size_t n = 0; n < found.size(); ++n) out[k * static_cast<std::size_t>(most) + n] = found[n].second;
  }
  return out;
}

}  // namespace irsim
