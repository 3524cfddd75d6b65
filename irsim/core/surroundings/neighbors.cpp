#include "surroundings/neighbors.hpp"

#include <algorithm>

#include "world/state.hpp"
#include "world/world.hpp"

namespace irsim {
namespace {

constexpr std::size_t kMaxLinearObjects = 256;  // up to this many objects are searched one by one

bool is_line(const Shapes& shapes, int object) {
  return shapes.parts[shapes.body[object].part].kind == Kind::linestring;
}

/// A grid with cells of about half the reach. The sizes are powers of 2, so that behaviors of similar reach share it.
const Points& level_for(Neighbors& near, double reach) {
  const double cell = std::exp2(std::ceil(std::log2(std::max(reach, 1e-3)))) * 0.5;
  for (std::size_t k = 0; k < near.used; ++k) {
    if (near.levels[k].cell == cell) return near.levels[k].points;
  }
  if (near.used == near.levels.size()) near.levels.emplace_back();
  Neighbors::Level& level = near.levels[near.used++];
  level.cell = cell;
  level.points.build(near.bounds, cell);
  return level.points;
}

}  // namespace

const Neighbors& neighbors(const World& world, const State& state, Workspace& work, int w) {
  Neighbors& near = work.neighbors;
  if (near.known) return near;
  near.known = true;
  near.used = 0;
  near.off_centre = near.off_origin = 0.0;
  near.lines.clear();
  near.bounds.resize(world.moving.size());
  near.discs.resize(world.moving.size());
  const Shapes& shapes = *state.scenes[w].shapes;
  for (std::size_t m = 0; m < world.moving.size(); ++m) {
    const int i = world.moving[m], row = w * world.objects + i;
    const Vec2 origin = state.pose[row].position(), direction = state.heading(row);
    near.bounds[m] = origin + rotate(shapes.centre[i], direction);
    near.discs[m] = {origin + rotate(shapes.centroid[i], direction), velocity_world(world, state, row, near.extra),
                     shapes.radius[i], i};
    if (is_line(shapes, i)) {
      near.bounds[m] = {kNone, kNone};
      if (!state.absent(row)) near.lines.push_back(i);
    } else {
      near.off_centre = std::max(near.off_centre, norm(shapes.centroid[i] - shapes.centre[i]));
      near.off_origin = std::max(near.off_origin, norm(shapes.centre[i]));
    }
  }
  return near;
}

const std::vector<int>& neighbors_within(const World& world, const State& state, Workspace& work, int w, Vec2 centre,
                                         double reach) {
  neighbors(world, state, work, w);
  Neighbors& near = work.neighbors;
  std::vector<int>& found = near.found;
  found.clear();
  const Fixed& fixed = *state.scenes[w].fixed;
  bool sorted = true;
  if (near.bounds.size() <= kMaxLinearObjects || !std::isfinite(reach)) {
    const double reach2 = reach * reach;
    const std::size_t total = near.bounds.size();
    if (near.tested.size() < total) near.tested.resize(total);
    const Vec2* bounds = near.bounds.data();
    const int* ids = world.moving.data();
    int* const first = near.tested.data();
    int* end = first;
    for (std::size_t m = 0; m < total; ++m) {  // without a branch, which the processor could not foresee
      *end = ids[m];
      end += squared(bounds[m] - centre) <= reach2;
    }
    found.assign(first, end);
  } else {
    sorted = false;
    level_for(near, reach).query(centre, reach, [&](int m) { found.push_back(world.moving[m]); });
  }
  if (!fixed.disc_points.empty()) {
    sorted = false;
    fixed.disc_points.query(centre, reach, [&](int k) { found.push_back(fixed.disc_ids[k]); });
  }
  if (!sorted) std::sort(found.begin(), found.end());
  return found;
}

Disc disc_of(const World& world, const State& state, const Workspace& work, int w, int object) {
  const Shapes& shapes = *state.scenes[w].shapes;
  const int slot = shapes.placed[object].object;
  if (!world.is_static[object]) return work.neighbors.discs[slot];
  const Fixed& fixed = *state.scenes[w].fixed;
  const Pose& pose = fixed.poses[slot];
  return {pose.position() + rotate(shapes.centroid[object], unit(pose.theta)), {}, shapes.radius[object], object};
}

}  // namespace irsim
