// Contacts within a step of objects that are apart at both of its ends.
#include <algorithm>
#include <tuple>

#include "collision/distance.hpp"
#include "collision/swept.hpp"
#include "collision/touch.hpp"
#include "geometry/predicates.hpp"
#include "phases.hpp"

namespace irsim {
namespace {

constexpr double kRounding = 1e-6;  // slack of bounding circles, far above rounding errors [m]
constexpr double kResting = 1e-5;   // gap up to which bodies that push each other are in contact [m]
constexpr double kSoon = 1e-8;      // time after a first contact at which the bodies may overlap for the first time
constexpr int kSamples = 64;        // poses within a step that are looked at to describe a contact

Moving moving_of(const World& world, const State& state, int w, int object) {
  const Scene& scene = state.scenes[w];
  const bool rests = world.is_static[object] || scene.shapes->is_map(object);
  if (rests) return resting_body(state.footprint(world, w, object));
  return moving_body(*scene.shapes, object, stride_of(world, state, w, object));
}

/// The footprint of an object at a time within the step.
Footprint footprint_at(const World& world, State& state, int w, int object, const Moving& body, double time) {
  Scene& scene = state.scenes[w];
  if (world.is_static[object]) return state.footprint(world, w, object);
  scene.trial.resize(scene.shapes->size[0]);
  const Pose pose = body.stride.at(time);
  scene.trial.place(*scene.shapes, object, pose, unit(pose.theta));
  return scene.trial.footprint(*scene.shapes, object);
}

/// Whether the bounding circles of two objects come near each other in this step.
bool come_near(const State& state, const World& world, int w, int a, int b, const Moving& one, const Moving& other) {
  const Shapes& shapes = *state.scenes[w].shapes;
  const Vec2 to = state.bounds(world, w, b).first - state.bounds(world, w, a).first;
  const Vec2 from = to - other.stride.by + one.stride.by;
  const auto slack = [&](int i, const Moving& body) {
    const double turn = std::fabs(body.stride.turn);
    const Vec2 centre = shapes.centre[i];
    return std::min(turn, 2.0) * (std::fabs(centre.x) + std::fabs(centre.y)) + body.stride.bulge(0.0);
  };
  const double reach = shapes.radius[a] + shapes.radius[b] + slack(a, one) + slack(b, other) + kRounding;
  return squared(nearest_on_segment(from, to, {})) <= reach * reach;
}

/// Whether two objects touch, or push each other, at a time within the step.
bool in_contact(const World& world, State& state, int w, int a, int b, const Moving& one, const Moving& other,
                double time) {
  const Footprint p = footprint_at(world, state, w, a, one, time), q = footprint_at(world, state, w, b, other, time);
  if (touch(p, q)) return true;
  return world.collision_mode == kContact && distance(p, q) < kResting;
}

/// Whether two bodies that come within a rounding error of each other at a time overlap afterwards.
bool overlap_after(const World& world, State& state, int w, int a, int b, const Moving& one, const Moving& other,
                   double when) {
  for (double later = kSoon; when + later < 1.0; later *= 1.5) {
    const Footprint p = footprint_at(world, state, w, a, one, when + later);
    if (touch(p, footprint_at(world, state, w, b, other, when + later))) return true;
  }
  return false;
}

double deepest(const World& world, State& state, int w, int a, int b, const Moving& one, const Moving& other,
               double when) {
  const auto overlap = [&](double time) {
    return -distance(footprint_at(world, state, w, a, one, time), footprint_at(world, state, w, b, other, time));
  };
  double most = 0.0, at = when, width = (1.0 - when) / kSamples;
  for (int k = 0; k <= kSamples; ++k) {
    const double time = when + k * width, depth = overlap(time);
    if (depth > most) most = depth, at = time;
  }
  for (int round = 0; round < 20; ++round) {
    width *= 0.5;
    for (const double time : {at - width, at + width}) {
      const double depth = overlap(clip(time, 0.0, 1.0));
      if (depth > most) most = depth, at = time;
    }
  }
  return most;
}

/// A point in the middle of an object, in the frame of its stride. Lines, rooms and maps that rest have none.
bool middle_of(const World& world, const Shapes& shapes, int object, const Moving& body, Vec2& middle) {
  middle = world.is_static[object] ? body.centre : shapes.centroid[object];
  if (!world.is_static[object]) return true;
  for (int p = 0; p < body.count; ++p) {
    const Part& part = body.parts[p];
    const Vec2* first = body.vertices + part.first;
    if (part.kind == Kind::circle && squared(middle - *first) <= part.radius * part.radius) return true;
    if (part.kind == Kind::polygon && inside_ring(first, part.last - part.first, middle)) return true;
  }
  return false;
}

/// Whether the middle of object `a` goes through object `b`, as seen from the latter.
bool goes_through(const World& world, State& state, int w, int a, int b, const Moving& one, const Moving& other) {
  Scene& scene = state.scenes[w];
  Vec2 middle;
  if (!middle_of(world, *scene.shapes, a, one, middle)) return false;
  Vec2 path[kSamples + 1];
  Box box;
  for (int k = 0; k <= kSamples; ++k) {
    const double time = static_cast<double>(k) / kSamples;
    const Pose mine = one.stride.at(time), theirs = other.stride.at(time);
    const Vec2 place = mine.position() + rotate(middle, unit(mine.theta));
    path[k] = unrotate(place - theirs.position(), unit(theirs.theta));
    box.include(path[k]);
  }
  const Part line{Kind::linestring, 0, kSamples, 0.0, 0.0};
  const Footprint way{&line, 1, path, &box, box, {}, 0.0};
  if (world.is_static[b]) return touch(way, state.footprint(world, w, b));
  scene.trial.resize(scene.shapes->size[0]);
  scene.trial.place(*scene.shapes, b, {}, {1.0, 0.0});
  return touch(way, scene.trial.footprint(*scene.shapes, b));
}

}  // namespace

Stride stride_of(const World& world, const State& state, int w, int object) {
  const int row = w * world.objects + object;
  const bool arc = world.integration == kExact && world.dynamics[object].driven;
  return Stride::between(state.before[row], state.pose[row], state.twist[row][2] * world.step_time, arc);
}

void meet(const World& world, State& state, int w, int a, int b) {
  if (world.unobstructed[a] || world.unobstructed[b]) return;
  const int first = w * world.objects;
  for (const int i : {a, b}) {
    if (state.appeared[first + i] == state.count[w] && state.appeared[first + i] > 0) return;  // it was not there
  }
  const Moving one = moving_of(world, state, w, a), other = moving_of(world, state, w, b);
  if (one.stride.rests() && other.stride.rests()) return;
  if (!come_near(state, world, w, a, b, one, other)) return;
  Scene& scene = state.scenes[w];
  Vec2 where;
  const double when = first_contact(one, other, 0.0, 1.0, scene.swept, where);
  if (!(when <= 1.0)) return;
  for (const double end : {0.0, 1.0}) {
    if (in_contact(world, state, w, a, b, one, other, end)) return;
  }
  for (const Contact& contact : scene.contacts) {
    if (contact.a == a && contact.b == b) return;  // they have pushed each other apart
  }
  if (!overlap_after(world, state, w, a, b, one, other, when)) return;
  const double depth = deepest(world, state, w, a, b, one, other, when);
  const bool through =
      goes_through(world, state, w, a, b, one, other) || goes_through(world, state, w, b, a, other, one);
  scene.meetings.push_back({a, b, when, where, depth, through});
}

void log_meetings(const World& world, State& state, int w) {
  std::vector<Meeting>& meetings = state.scenes[w].meetings;
  if (meetings.empty()) return;
  const auto before = [](const Meeting& p, const Meeting& q) { return std::tie(p.a, p.b) < std::tie(q.a, q.b); };
  std::sort(meetings.begin(), meetings.end(), before);
  for (const Meeting& meeting : meetings) {
    const EventKind kind = meeting.through ? EventKind::passed_through : EventKind::contact_between_steps;
    state.log(world, w, kind, meeting.a, meeting.b, meeting.where);
    Event& event = state.scenes[w].events.back();
    event.when = meeting.when, event.depth = meeting.depth;
    for (const int i : {meeting.a, meeting.b}) ++state.between_steps[w * world.objects + i];
  }
}

}  // namespace irsim
