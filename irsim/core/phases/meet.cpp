// Contacts within a step of objects that are apart at both of its ends.
#include <algorithm>
#include <tuple>

#include "collision/distance.hpp"
#include "collision/touch.hpp"
#include "geometry/predicates.hpp"
#include "phases.hpp"
#include "phases/strides.hpp"

namespace irsim {
namespace {

constexpr int kSamples = 64;  // poses within a step that are looked at to describe a contact

double deepest(const Passage& passage, double when) {
  double most = 0.0, at = when, width = (1.0 - when) / kSamples;
  for (int k = 0; k <= kSamples; ++k) {
    const double time = when + k * width, depth = -passage.gap(time);
    if (depth > most) most = depth, at = time;
  }
  for (int round = 0; round < 20; ++round) {
    width *= 0.5;
    for (const double time : {at - width, at + width}) {
      const double depth = -passage.gap(clip(time, 0.0, 1.0));
      if (depth > most) most = depth, at = time;
    }
  }
  return most;
}

/// A point in the middle of an object, in the frame of its stride. Lines, rooms and maps that rest do not have one.
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

void meet(const World& world, State& state, int w, int a, int b) {
  if (!come_near(world, state, w, a, b)) return;
  const Passage passage(world, state, w, a, b);
  Vec2 where;
  const double when = passage.first_contact(0.0, 1.0, where);
  if (when <= 1.0 && !passage.in_contact(0.0) && !passage.in_contact(1.0) && passage.overlap_after(when))
    keep_meeting(world, state, w, passage, when, where);
}

void keep_meeting(const World& world, State& state, int w, const Passage& passage, double when, Vec2 where) {
  const int a = passage.a, b = passage.b;
  const Moving &one = passage.one, &other = passage.other;
  const double depth = deepest(passage, when);
  const bool through =
      goes_through(world, state, w, a, b, one, other) || goes_through(world, state, w, b, a, other, one);
  add_pair(state.scenes[w].meetings, Meeting{a, b, when, where, depth, through});
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
