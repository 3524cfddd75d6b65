#include "phases/strides.hpp"

#include <algorithm>

#include "collision/distance.hpp"
#include "collision/support.hpp"
#include "collision/touch.hpp"
#include "geometry/predicates.hpp"

namespace irsim {
namespace {

constexpr double kRounding = 1e-6;  // slack of bounding circles, far above rounding errors [m]
constexpr double kResting = 1e-5;   // gap up to which bodies that push each other are in contact [m]
constexpr double kSoon = 1e-8;      // time after a first contact at which the bodies may overlap for the first time

Moving moving_of(const World& world, const State& state, int w, int object) {
  const Scene& scene = state.scenes[w];
  const bool rests = world.is_static[object] || scene.shapes->is_map(object);
  if (rests) return resting_body(state.footprint(world, w, object));
  return moving_body(*scene.shapes, object, stride_of(world, state, w, object));
}

/// How far a turn in the step may carry an object out of the box that moves with it in a straight line [m].
double swing_of_step(const World& world, const State& state, int w, int object) {
  const Stride stride = stride_of(world, state, w, object);
  return std::min(std::fabs(stride.turn), 2.0) * state.scenes[w].shapes->arm[object] + stride.bulge(0.0);
}

}  // namespace

Stride stride_of(const World& world, const State& state, int w, int object) {
  const int row = w * world.objects + object;
  const bool arc = world.integration == kExact && world.dynamics[object].driven;
  return Stride::between(state.before[row], state.pose[row], state.twist[row][2] * world.step_time, arc);
}

void bound_steps(const World& world, State& state, int w, std::vector<Box>& out) {
  const Scene& scene = state.scenes[w];
  const Slot* placed = scene.shapes->placed.data();
  const double* arms = scene.shapes->arm.data();
  const bool arcs = world.integration == kExact;
  const Box* ends = scene.moving.boxes.data();
  const Pose *before = &state.before[w * world.objects], *now = &state.pose[w * world.objects];
  out.resize(scene.moving.boxes.size());
  Box* boxes = out.data();
  for (const int i : world.moving) {
    const int slot = placed[i].object;
    const Box end = ends[slot];
    const double x = before[i].x - now[i].x, y = before[i].y - now[i].y;
    const bool swings = before[i].theta != now[i].theta && (arcs || arms[i] > 0.0);
    const double swing = swings ? swing_of_step(world, state, w, i) : 0.0;
    boxes[slot] = {end.x0 + std::min(x, 0.0) - swing, end.y0 + std::min(y, 0.0) - swing,
                   end.x1 + std::max(x, 0.0) + swing, end.y1 + std::max(y, 0.0) + swing};
  }
}

Passage::Passage(const World& world, State& state, int w, int a_, int b_)
    : a(a_),
      b(b_),
      one(moving_of(world, state, w, a)),
      other(moving_of(world, state, w, b)),
      world_(world),
      state_(state),
      scene_(state.scenes[w]),
      w_(w) {}

void Passage::stop(int object, double time) {
  Moving& body = object == a ? one : other;
  whole_ = false;
  if (!world_.is_static[object]) body.stride = Stride::resting(body.stride.at(time));
}

bool come_near(const World& world, const State& state, int w, int a, int b) {
  if (world.unobstructed[a] || world.unobstructed[b]) return false;
  const Scene& scene = state.scenes[w];
  const Shapes& shapes = *scene.shapes;
  double reach = shapes.radius[a] + shapes.radius[b] + kRounding;
  Vec2 to, from;  // from the centre of the circle of `a` to the centre of the circle of `b`, at both ends of the step
  const auto add = [&](int i, double sign) {
    const bool rests = world.is_static[i];
    const Vec2 end = (rests ? scene.fixed->outlines : scene.moving).centres[shapes.placed[i].object] * sign;
    to = to + end, from = from + end;
    if (rests || shapes.is_map(i)) return;
    const Pose &before = state.before[w * world.objects + i], &now = state.pose[w * world.objects + i];
    from = from - (now.position() - before.position()) * sign;
    const Vec2 centre = shapes.centre[i];
    const double arm = std::fabs(centre.x) + std::fabs(centre.y);
    if (before.theta == now.theta || (arm == 0.0 && world.integration == kEuler)) return;
    const Stride stride = stride_of(world, state, w, i);
    reach += std::min(std::fabs(stride.turn), 2.0) * arm + stride.bulge(0.0);
  };
  add(a, -1.0), add(b, 1.0);
  return squared(nearest_on_segment(from, to, {})) <= reach * reach;
}

bool Passage::stay_apart() const {
  const Shapes& shapes = *scene_.shapes;
  const auto placed = [&](int i) {
    return (world_.is_static[i] ? scene_.fixed->outlines : scene_.moving).footprint(shapes, i);
  };
  const auto swing = [&](int i, const Stride& stride) {
    if (stride.turn == 0.0) return 0.0;
    const Vec2 centre = shapes.centre[i];
    return std::fabs(stride.turn) * (std::fabs(centre.x) + std::fabs(centre.y) + shapes.radius[i]) + stride.bulge(0.0);
  };
  const Footprint p = placed(a), q = placed(b);
  const Vec2 between = q.centre - p.centre, relative = one.stride.by - other.stride.by;
  const double turning = swing(a, one.stride) + swing(b, other.stride) + kRounding;
  const auto apart_along = [&](Vec2 axis) {
    const double length = norm(axis);
    if (!(length > 0.0)) return false;
    axis = axis * (1.0 / length);
    const double end = -support(q, axis * -1.0) - support(p, axis);
    return end > kRounding && end + dot(axis, relative) > turning;  // both ends; in between it is a straight line
  };
  const Vec2 beside{-relative.y, relative.x};
  return apart_along(between) || apart_along(dot(beside, between) < 0.0 ? beside * -1.0 : beside);
}

double Passage::first_contact(double begin, double end, Vec2& where) const {
  if (world_.unobstructed[a] || world_.unobstructed[b]) return kInfinity;
  if (one.stride.rests() && other.stride.rests()) return kInfinity;
  for (const int i : {a, b}) {
    const std::int64_t since = state_.appeared[w_ * world_.objects + i];
    if (since > 0 && since == state_.count[w_]) return kInfinity;
  }
  if (!scene_.bent.empty() && (scene_.bent[a] || scene_.bent[b])) return kInfinity;  // contacts looked after them
  if (std::binary_search(scene_.parted.begin(), scene_.parted.end(), Pair{a, b})) return kInfinity;
  if (whole_ && stay_apart()) return kInfinity;
  return irsim::first_contact(one, other, begin, end, scene_.swept, where);
}

Footprint Passage::footprint(int object, const Moving& body, double time) const {
  if (world_.is_static[object]) return scene_.fixed->outlines.footprint(*scene_.shapes, object);
  scene_.trial.resize(scene_.shapes->size[0]);
  const Pose pose = body.stride.at(time);
  scene_.trial.place(*scene_.shapes, object, pose, unit(pose.theta));
  return scene_.trial.footprint(*scene_.shapes, object);
}

double Passage::gap(double time) const {
  const Footprint p = footprint(a, one, time);
  return distance(p, footprint(b, other, time));
}

bool Passage::touch_at(double time) const {
  const Footprint p = footprint(a, one, time);
  return touch(p, footprint(b, other, time));
}

bool Passage::in_contact(double time) const {
  return touch_at(time) || (world_.collision_mode == kContact && gap(time) < kResting);
}

bool Passage::overlap_after(double when) const {
  for (double later = kSoon; when + later < 1.0; later *= 1.5) {
    if (touch_at(when + later)) return true;
  }
  return touch_at(1.0);
}

}  // namespace irsim
