#include "contact/parts.hpp"

#include <algorithm>

#include "contact/bodies.hpp"
#include "phases.hpp"
#include "phases/strides.hpp"

namespace irsim {
namespace {

constexpr double kFast = 0.5;   // share of the thickness of two bodies that one may move into the other at once
constexpr double kPart = 0.25;  // the same, in a part of a step
constexpr int kMostParts = 4000;

/// How far a point of a moving object moves in the step [m].
double way_of(const World& world, const State& state, int w, int object) {
  const Stride stride = stride_of(world, state, w, object);
  const Shapes& shapes = *state.scenes[w].shapes;
  const double way = norm(stride.by) + std::fabs(stride.turn) * (norm(shapes.centre[object]) + shapes.radius[object]);
  return std::isfinite(way) ? way : 0.0;
}

Box wider(const Box& box, double by) { return {box.x0 - by, box.y0 - by, box.x1 + by, box.y1 + by}; }

/// The pairs of objects whose boxes in the step come within `reach` of each other, and of which one can be pushed.
void find_near(const World& world, State& state, int w, double reach, std::vector<std::pair<int, int>>& out) {
  Scene& scene = state.scenes[w];
  out.clear();
  const auto add = [&](int i, int j) {
    if (world.unobstructed[i] || world.unobstructed[j]) return;
    if (world.dynamics[i].pushable || world.dynamics[j].pushable) out.emplace_back(std::min(i, j), std::max(i, j));
  };
  bound_steps(world, state, w, scene.ways);
  const auto box = [&](int i) { return scene.ways[scene.shapes->placed[i].object]; };
  if (!world.fixed_objects.empty()) {
    for (const int i : world.moving) scene.fixed->grid.query(wider(box(i), reach), [&](int j) { add(i, j); });
  }
  if (world.moving.size() > 1) {
    scene.sweep.pairs([&](int i) { return wider(box(i), 0.5 * reach); }, add);
  }
  std::sort(out.begin(), out.end());
}

void merge(std::vector<Contact>& all, const std::vector<Contact>& now, double share) {
  for (const Contact& contact : now) {
    auto known = std::find_if(all.begin(), all.end(),
                              [&](const Contact& one) { return one.a == contact.a && one.b == contact.b; });
    if (known == all.end()) {
      all.push_back(contact);
      all.back().force *= share;
      continue;
    }
    const double force = known->force + contact.force * share;
    if (contact.depth > known->depth) *known = contact;
    known->force = force;
  }
}

}  // namespace

int parts_of_step(const World& world, State& state, int w, Workspace& work) {
  Scene& scene = state.scenes[w];
  if (!scene.in_motion) return 1;
  const Bodies& bodies = bodies_of(world, state, w);
  double far = 0.0, thinnest = kInfinity, thin = kInfinity;
  for (const int i : world.moving) far = std::max(far, way_of(world, state, w, i));
  for (int i = 0; i < world.objects; ++i) {
    if (world.unobstructed[i]) continue;
    thin = std::min(thin, bodies.width[i]);
    if (world.dynamics[i].pushable) thinnest = std::min(thinnest, bodies.width[i]);
  }
  if (!(2.0 * far > kFast * (thinnest + thin))) return 1;
  scene.contacts.clear();
  place_moving(world, state, w);
  std::vector<std::pair<int, int>>& near = work.contacts.met;
  find_near(world, state, w, far, near);
  double least = kInfinity, way = 0.0;
  for (const auto& [a, b] : near) {
    const auto moved = [&](int i) { return world.is_static[i] ? 0.0 : way_of(world, state, w, i); };
    const double both = moved(a) + moved(b);
    double thick = bodies.width[a] + bodies.width[b];  // of this pair, or of one that may follow from it
    for (const auto& [i, j] : near) {
      for (const int k : {a, b}) {
        if ((i == k || j == k) && world.dynamics[k].pushable)
          thick = std::min(thick, bodies.width[i] + bodies.width[j]);
      }
    }
    if (!(both > kFast * thick)) continue;
    const Passage passage(world, state, w, a, b);
    Vec2 where;
    if (!(passage.first_contact(0.0, 1.0, where) <= 1.0) && !passage.in_contact(0.0)) continue;
    least = std::min(least, thick), way = std::max(way, both);
  }
  if (!(way > kFast * least)) return 1;
  return static_cast<int>(clip(std::ceil(way / (kPart * least)), 2.0, kMostParts));
}

void push_in_parts(const World& world, State& state, int w, Workspace& work, const Resolution& options, int parts) {
  Scene& scene = state.scenes[w];
  ContactBuffers& buffers = work.contacts;
  const int first = w * world.objects;
  buffers.merged.clear();
  buffers.drift.assign(world.objects, Vec3{});
  buffers.end.assign(&state.pose[first], &state.pose[first] + world.objects);
  std::vector<Stride>& strides = buffers.strides;
  strides.clear();
  buffers.twists.resize(world.objects);
  for (const int i : world.moving) {
    strides.push_back(stride_of(world, state, w, i));
    state.pose[first + i] = state.before[first + i];
  }
  std::vector<std::uint8_t>& touched = buffers.touched;
  touched.assign(world.objects, 0);
  for (int part = 0; part < parts; ++part) {
    for (std::size_t m = 0; m < world.moving.size(); ++m) {
      const int i = world.moving[m];
      const double begin = static_cast<double>(part) / parts, end = static_cast<double>(part + 1) / parts;
      const Pose from = strides[m].at(begin), to = strides[m].at(end);
      Pose& pose = state.pose[first + i];
      const Vec3& drift = buffers.drift[i];
      pose.x += to.x - from.x + drift[0], pose.y += to.y - from.y + drift[1];
      pose.theta =
          into_range(wrap(pose.theta + (to.theta - from.theta) + drift[2]), world.angle_low[i], world.angle_high[i]);
      buffers.twists[i] = state.twist[first + i];
    }
    push_apart(world, state, w, work, options, nullptr);
    for (const int i : world.moving) {
      for (int c = 0; c < 3; ++c)
        buffers.drift[i][c] += (state.twist[first + i][c] - buffers.twists[i][c]) * options.step_time;
    }
    for (const Contact& contact : scene.contacts) touched[contact.a] = touched[contact.b] = 1;
    merge(buffers.merged, scene.contacts, 1.0 / parts);
  }
  std::swap(scene.contacts, buffers.merged);
  for (const int i : world.moving) {
    if (!touched[i]) state.pose[first + i] = buffers.end[i];
  }
}

}  // namespace irsim
