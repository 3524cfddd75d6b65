// Which objects touch, and what the collision mode does about it.
#include <algorithm>

#include "collision/touch.hpp"
#include "phases.hpp"
#include "phases/strides.hpp"

namespace irsim {
namespace {

/// Find the pairs that touch now or have touched since the last evaluation.
void find_pairs(const World& world, State& state, int w) {
  Scene& scene = state.scenes[w];
  const Shapes& shapes = *scene.shapes;
  const Fixed& fixed = *scene.fixed;
  const bool moved = scene.in_motion, judged = world.contacts == kSwept;
  std::vector<Pair>& pairs = scene.pairs;
  pairs.assign(fixed.pairs.begin(), fixed.pairs.end());
  scene.meetings.clear(), scene.near.clear(), scene.parted.clear();
  for (const Contact& contact : scene.contacts) scene.parted.emplace_back(contact.a, contact.b);
  std::sort(scene.parted.begin(), scene.parted.end());
  const Slot* placed = shapes.placed.data();
  const Outlines& moving = scene.moving;
  const auto examine = [&](int i, int j, const Outlines& others) {
    const int a = std::min(i, j), b = std::max(i, j);
    if (judged) {
      add_pair(scene.near, NearPair{a, b, kInfinity, {}, false});
    } else if (moving.boxes[placed[i].object].meets(others.boxes[placed[j].object]) &&
               touch(moving.footprint(shapes, i), others.footprint(shapes, j))) {
      add_pair(pairs, Pair{a, b});
    } else if (moved) {
      meet(world, state, w, a, b);
    }
  };
  const bool alone = world.moving.size() < 2 && world.fixed_objects.empty();
  if (moved && !alone) bound_steps(world, state, w, scene.ways);
  const Box* boxes = moved ? scene.ways.data() : moving.boxes.data();
  const auto box = [=](int i) { return boxes[placed[i].object]; };
  if (!world.fixed_objects.empty()) {
    for (const int i : world.moving) fixed.grid.query(box(i), [&](int j) { examine(i, j, fixed.outlines); });
  }
  if (world.moving.size() > 1) {
    scene.sweep.pairs(box, [&](int i, int j) { examine(i, j, moving); });
  }
  if (judged) judge(world, state, w);
  if (pairs.size() > 1) std::sort(pairs.begin(), pairs.end());
  if (judged) pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

/// The contact of two objects within this step if that was judged; null otherwise.
const NearPair* judged_contact(const Scene& scene, int i, int j) {
  const std::vector<NearPair>& near = scene.near;  // sorted by objects
  const auto pair = std::lower_bound(near.begin(), near.end(), Pair{i, j},
                                     [](const NearPair& p, const Pair& q) { return Pair{p.a, p.b} < q; });
  return pair != near.end() && pair->judged && pair->a == i && pair->b == j ? &*pair : nullptr;
}

/// Where two objects touch at the end of the step.
Vec2 place_of_contact(const World& world, const State& state, int w, int i, int j) {
  Vec2 where;
  touch(state.footprint(world, w, i), state.footprint(world, w, j), where);
  return where;
}

/// Log contacts that began since the previous evaluation.
void log_contacts(const World& world, State& state, int w) {
  const Scene& scene = state.scenes[w];
  auto old = scene.previous_pairs.begin();
  for (const Pair& pair : scene.pairs) {
    while (old != scene.previous_pairs.end() && *old < pair) ++old;
    const auto [i, j] = pair;
    const NearPair* judged = scene.near.empty() ? nullptr : judged_contact(scene, i, j);
    const bool was_there = old != scene.previous_pairs.end() && *old == pair;
    if (was_there && (judged == nullptr || !judged->begins)) continue;  // not one contact after the other
    // An event needs a moving object or a robot that has met something obstructing.
    const bool first = !world.unobstructed[j] && (!world.is_static[i] || world.is_robot[i]);
    const bool second = !world.unobstructed[i] && (!world.is_static[j] || world.is_robot[j]);
    if (!first && !second) continue;
    const Vec2 where = judged == nullptr ? place_of_contact(world, state, w, i, j) : judged->where;
    state.log(world, w, EventKind::collision, i, j, where);
    if (judged != nullptr) state.scenes[w].events.back().when = judged->when;
  }
}

}  // namespace

void place_moving(const World& world, State& state, int w) {
  Scene& scene = state.scenes[w];
  const int first = w * world.objects;
  for (const int i : world.moving) {
    const int row = first + i;
    const Pose& pose = state.pose[row];
    if (state.direction_of[row] != pose.theta) {
      state.direction[row] = unit(pose.theta);
      state.direction_of[row] = pose.theta;
    }
    scene.moving.place(*scene.shapes, i, pose, state.direction[row]);
  }
}

void collide(const World& world, State& state, int w) {
  Scene& scene = state.scenes[w];
  std::swap(scene.pairs, scene.previous_pairs);
  place_moving(world, state, w);
  find_pairs(world, state, w);
  scene.in_motion = false;
  scene.bent.clear();
  const int first = w * world.objects;
  std::uint8_t* collided = state.collided.data + first;
  std::fill(collided, collided + world.objects, std::uint8_t{0});
  for (const auto& [i, j] : scene.pairs) {
    if (!world.unobstructed[j]) collided[i] = 1;
    if (!world.unobstructed[i]) collided[j] = 1;
  }
  log_contacts(world, state, w);
  if (!scene.meetings.empty()) log_meetings(world, state, w);
  for (int i = 0; i < world.objects; ++i) {
    const bool stops =
        world.collision_mode == kStop || (world.collision_mode == kUnobstructedObstacles && world.is_robot[i]);
    state.stopped[first + i] = stops && !world.unstoppable[i] ? collided[i] : 0;
  }
}

}  // namespace irsim
