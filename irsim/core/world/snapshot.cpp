#include "world/snapshot.hpp"

#include <cstring>
#include <stdexcept>
#include <type_traits>

#include "world/variation.hpp"

namespace irsim {
namespace {

struct Writer {
  static constexpr bool kReads = false;
  std::vector<char> bytes;
  void raw(const void* from, std::size_t size) {
    const char* first = static_cast<const char*>(from);
    bytes.insert(bytes.end(), first, first + size);
  }
};

struct Reader {
  static constexpr bool kReads = true;
  const char *at, *end;
  void raw(void* to, std::size_t size) {
    if (size > left()) throw std::invalid_argument("the snapshot is cut off");
    if (size > 0) std::memcpy(to, at, size);
    at += size;
  }
  std::size_t left() const { return static_cast<std::size_t>(end - at); }
};

/// Writes values, or reads them, in one order.
template <class Bytes>
struct Walk {
  Bytes bytes;

  template <class... Values>
  void all(Values&... values) {
    (one(values), ...);
  }

  template <class Value>
  void one(Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    bytes.raw(&value, sizeof value);
  }
  template <class A, class B>
  void one(std::pair<A, B>& pair) {
    all(pair.first, pair.second);
  }
  template <class Value>
  void one(Array<Value>& array) {
    expect(array.size);
    bytes.raw(array.data, array.size * sizeof(Value));
  }
  template <class Value>
  void one(std::vector<Value>& list) {
    std::size_t size = list.size();
    one(size);
    if constexpr (Bytes::kReads) {
      if (size > bytes.left()) throw std::invalid_argument("the snapshot is cut off");
      list.resize(size);
    }
    if constexpr (std::is_trivially_copyable_v<Value>) {
      bytes.raw(list.data(), size * sizeof(Value));
    } else {
      for (Value& value : list) one(value);
    }
  }
  void one(GoalQueue& queue) { all(queue.goals, queue.initial, queue.head); }
  void one(Opinions& opinions) { all(opinions.step, opinions.tied, opinions.tied_before, opinions.of); }
  void one(Detour& d) {
    all(d.step, d.planned, d.blockers, d.leads, d.wide, d.goal, d.points, d.next, d.anchor, d.anchored);
  }
  void one(Route& r) {
    all(r.goal, r.path, r.next, r.planned_at, r.plans, r.legs, r.leg, r.blocked_steps, r.keeps_heading, r.parking_at);
    all(r.backing_steps, r.wall_radius, r.wall_margin, r.way_ahead, r.shortest_way, r.progress_at, r.held_up, r.track);
    all(r.retreats, r.wait_until, r.lets_pass, r.insists_until, r.right_of_way, r.retraced, r.reported, r.uncertain);
    all(r.failed_pose, r.parked, r.parked_seen, r.parked_reported, r.resting_at, r.resting_since, r.bodies);
  }
  void one(Body& body) {
    body.visit([&](auto&... values) { all(values...); });
  }
  void one(Watched& watched) { all(watched.position, watched.inside, watched.seen); }
  void one(Outlines& o) { all(o.vertices, o.part_boxes, o.boxes, o.centres); }
  void one(Scene& s) {
    all(s.moving, s.pairs, s.previous_pairs, s.events, s.contacts, s.watched, s.in_motion, s.meetings, s.near, s.held);
    all(s.bent, s.parted, s.until, s.ways);
    s.sweep.visit([&](auto&... values) { all(values...); });
  }

  /// A number that must be the same in both states.
  void expect(std::size_t number) {
    std::size_t there = number;
    one(there);
    if (there != number) throw std::invalid_argument("the snapshot is of another world");
  }

  void state(State& s) {
    for (const int number : {s.worlds, s.objects, s.extra_rows, static_cast<int>(s.keep_history)}) expect(number);
    all(s.pose, s.extra, s.control, s.twist, s.command, s.commanded, s.drive, s.contact_time, s.air_time, s.given);
    all(s.arrived, s.believes_arrived, s.collided, s.stopped, s.touching, s.radius, s.vel_min, s.vel_max, s.acce,
        s.pace, s.start_step);
    all(s.appeared, s.takes_part, s.size_scale, s.speed_scale, s.acceleration_scale, s.noise_scale, s.latency);
    all(s.infeasible, s.between_steps, s.goal, s.ranges, s.beam_angles, s.hits, s.valid, s.velocities, s.explored);
    all(s.count, s.scene_index, s.noise, s.level, s.variant, s.seed, s.failed_placement);
    all(s.direction, s.direction_of, s.goals, s.routes, s.target, s.opinions, s.detours, s.tied, s.goal_draws);
    all(s.before, s.overshot, s.initial_pose, s.initial_extra, s.initial_control, s.history, s.standings, s.fresh);
    all(s.readings, s.memory, s.stamp, s.pending.time, s.pending.ranges, s.pending.velocities, s.pending.readings);
    all(s.pending.hits, s.pending.valid);
    all(s.event_count, s.scenes, s.actuated, s.underfoot, s.queue, s.delay_scale, s.lag_scale);
    all(s.sensor_rate_scale, s.sensor_latency_scale, s.slip_scale, s.grip_scale);
  }

  /// The body-frame geometry of a world; the cells of maps are given by their number among `grids`.
  void shapes(Shapes& s) {
    all(s.body, s.vertices, s.centre, s.centroid, s.radius, s.arm, s.placed, s.size, s.scale);
    std::size_t count = s.parts.size();
    one(count);
    if constexpr (Bytes::kReads) s.parts.resize(std::min(count, bytes.left()));
    for (Part& part : s.parts) {
      std::size_t cells = 0;
      while (cells < s.grids.size() && s.grids[cells].get() != part.cells) ++cells;
      all(part.kind, part.first, part.last, part.radius, part.turn, cells);
      if constexpr (Bytes::kReads) part.cells = cells < s.grids.size() ? s.grids[cells].get() : nullptr;
    }
  }
};

std::vector<char> bytes_of(const Shapes& shapes) {
  Walk<Writer> out;
  out.shapes(const_cast<Shapes&>(shapes));
  return std::move(out.bytes.bytes);
}

/// Replace the shapes of a world unless they are the same; shapes equal to its variant's are shared with it.
void replace_shapes(const World& world, State& state, int w, const std::vector<char>& wanted) {
  Scene& scene = state.scenes[w];
  if (bytes_of(*scene.shapes) == wanted) return;
  const World& from = variant_of(world, state, w);
  if (from.shapes && bytes_of(*from.shapes) == wanted) {
    scene.shapes = from.shapes;
    return;
  }
  auto shapes = std::make_shared<Shapes>(from.shapes ? *from.shapes : *scene.shapes);  // with the cells of its maps
  Walk<Reader> in{{wanted.data(), wanted.data() + wanted.size()}};
  in.shapes(*shapes);
  scene.shapes = std::move(shapes);
}

}  // namespace

std::vector<char> save(State& state) {
  Walk<Writer> out;
  out.state(state);
  for (Scene& scene : state.scenes) {
    std::vector<char> shapes = bytes_of(*scene.shapes);
    out.one(shapes);
  }
  for (int row = 0; row < static_cast<int>(state.routes.size()); ++row) {
    bool current = state.routes[row].planned_among == state.scenes[row / state.objects].fixed;
    out.one(current);
  }
  return std::move(out.bytes.bytes);
}

void load(const World& world, State& state, const char* bytes, std::size_t size) {
  Walk<Reader> in{{bytes, bytes + size}};
  in.state(state);
  for (int w = 0; w < state.worlds; ++w) {
    std::vector<char> shapes;
    in.one(shapes);
    const std::shared_ptr<const Shapes> before = state.scenes[w].shapes;
    replace_shapes(world, state, w, shapes);
    if (state.scenes[w].shapes != before) state.scenes[w].fixed = nullptr, state.scenes[w].bodies = nullptr;
    place_fixed(world, state, w);
  }
  for (int row = 0; row < static_cast<int>(state.routes.size()); ++row) {
    bool current = false;
    in.one(current);
    state.routes[row].planned_among = current ? state.scenes[row / state.objects].fixed : nullptr;
  }
  if (in.bytes.left() != 0) throw std::invalid_argument("the snapshot is of another world");
}

}  // namespace irsim
