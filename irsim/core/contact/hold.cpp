#include "contact/hold.hpp"

#include <algorithm>

#include "collision/touch.hpp"
#include "contact/near.hpp"
#include "contact/solver.hpp"
#include "phases.hpp"

namespace irsim {
namespace {

constexpr int kRounds = 6;                     // of holding and pushing apart, in a step or a part of one
constexpr int kRoundsOfStep = 256;             // the same of all parts together, after which bodies are only held
constexpr int kMaxPairsSolved = 20000;         // in all rounds together; larger crowds are only held
constexpr std::size_t kMaxPairsHeld = 100000;  // in larger crowds bodies are only held at what cannot be pushed
constexpr double kHeldGap = 1e-6;              // gap that is left where a body is held [m]

bool is_before(const Contact& p, const Contact& q) { return p.a != q.a ? p.a < q.a : p.b < q.b; }

class Holder {
 public:
  Holder(const World& world, State& state, int w, Workspace& work, const Begun& begun)
      : world_(world),
        state_(state),
        w_(w),
        work_(work),
        scene_(state.scenes[w]),
        bodies_(bodies_of(world, state, w)),
        begun_(begun),
        first_(w * world.objects) {}

  /// Put back every body that went through another one. Returns whether any did.
  bool hold() {
    double far = 0.0;
    work_.contacts.went.clear();
    for (std::size_t m = 0; m < world_.moving.size(); ++m) {
      const int i = world_.moving[m];
      const Pose &from = begun_.from[m], &to = state_.pose[first_ + i];
      work_.contacts.went.push_back(Stride::between(from, to, begun_.turn[m], false));
      const double way = way_of(i, work_.contacts.went.back());
      if (std::isfinite(way)) far = std::max(far, way);
    }
    const bool deep = are_deep();
    if (!deep && !(2.0 * far > kFast * (bodies_.lightest + bodies_.thinnest))) return false;
    const bool crowded = work_.contacts.pairs.size() > kMaxPairsHeld;
    const auto box = [&](int i) { return box_of(i); };
    near_pairs(world_, scene_, box, box, !crowded, work_.contacts.met);
    std::vector<double>& until = work_.contacts.until;
    until.assign(world_.objects, 1.0);
    const Resolution none{0, 0, 0.0, world_.step_time};
    ContactSolver solver(world_, state_, w_, work_, none);
    solver.place_moving();
    bool any = false;
    for (const auto& [a, b] : work_.contacts.met) {
      const double way = way_of(a, stride(a)) + way_of(b, stride(b));
      const bool both = world_.dynamics[a].pushable && world_.dynamics[b].pushable;
      if ((both || !deep) && !(way > kFast * (bodies_.width[a] + bodies_.width[b]))) continue;
      if (!(way > 0.0)) continue;
      const double when = time_of_meeting(solver, a, b);
      if (!(when <= 1.0)) continue;
      any = true;
      for (const int i : {a, b}) {
        if (world_.dynamics[i].pushable) until[i] = std::min(until[i], when);
      }
    }
    for (const int i : world_.moving) {
      if (until[i] < 1.0) put_back(i, until[i]);
    }
    return any;
  }

 private:
  /// Whether some bodies overlapped almost as far as to their cores: however little they move, it adds up.
  bool are_deep() const {
    const auto is_deep = [&](const Contact& contact) {
      return contact.depth > 0.3 * kFast * (bodies_.width[contact.a] + bodies_.width[contact.b]);
    };
    return std::any_of(scene_.contacts.begin(), scene_.contacts.end(), is_deep);
  }
  const Stride& stride(int i) const {
    return world_.is_static[i] ? rest_ : work_.contacts.went[scene_.shapes->placed[i].object];
  }
  /// How far a point of a body goes at most [m].
  double way_of(int i, const Stride& stride) const {
    return norm(stride.by) + way_of_turn(*scene_.shapes, bodies_, i, stride.turn);
  }
  Box box_of(int i) const {
    const Shapes& shapes = *scene_.shapes;
    const Stride& way = stride(i);
    const double reach = norm(shapes.centre[i]) + shapes.radius[i];
    Box box = box_around(way.from.position(), reach);
    box.include(box_around(way.from.position() + way.by, reach));
    return box;
  }
  /// The core of a body that can be pushed, or all of another one.
  Moving moving(int i) const {
    if (world_.is_static[i] || scene_.shapes->is_map(i)) return resting_body(state_.footprint(world_, w_, i));
    Moving body = moving_body(*scene_.shapes, i, stride(i));
    if (!world_.dynamics[i].pushable) return body;
    body.parts = bodies_.cores.data() + bodies_.core_begin[i];
    body.count = bodies_.core_begin[i + 1] - bodies_.core_begin[i];
    body.vertices = bodies_.core_vertices.data();
    return body;
  }
  /// When the core of a body comes to the other one, with a small gap; infinite if it does not.
  double time_of_meeting(ContactSolver& solver, int a, int b) {
    const Moving one = moving(a), other = moving(b);
    Vec2 where;
    const double when = first_contact(one, other, 0.0, 1.0, scene_.swept, where);
    if (!(when <= 1.0)) return kInfinity;
    const double before = kHeldGap / (way_of(a, stride(a)) + way_of(b, stride(b)));
    if (when > 2.0 * before) return when - before;
    // They overlap deeply where they begin. They may part, but not on the other side of a wall.
    const int wall = world_.is_static[a] ? a : b, body = wall == a ? b : a;
    if (!world_.is_static[wall]) return kInfinity;
    if (middle_passes(body, wall)) return 0.0;
    const double first = solver.overlap_at(a, b, one.stride.from, other.stride.from).depth,
                 last = solver.overlap_at(a, b, one.stride.at(1.0), other.stride.at(1.0)).depth;
    return last > first ? 0.0 : kInfinity;
  }
  /// Whether the middle of a piece of a body, which is free at the beginning, meets a wall.
  bool middle_passes(int body, int wall) {
    const Footprint solid = state_.footprint(world_, w_, wall);
    const Stride& way = stride(body);
    for (int p = bodies_.core_begin[body]; p < bodies_.core_begin[body + 1]; ++p) {
      const Part& core = bodies_.cores[p];
      const int count = core.kind == Kind::polygon ? core.last - core.first : core.last - core.first + 1;
      Vec2 middle;
      for (int v = core.first; v < core.first + count; ++v) middle = middle + bodies_.core_vertices[v] * (1.0 / count);
      const auto place = [&](const Pose& at) { return at.position() + rotate(middle, unit(at.theta)); };
      const Vec2 path[] = {place(way.from), place(way.at(1.0))};
      Box start, box;
      start.include(path[0]), box.include(path[0]), box.include(path[1]);
      const Part point{Kind::circle, 0, 0, 0.0, 0.0}, line{Kind::linestring, 0, 1, 0.0, 0.0};
      if (touch({&line, 1, path, &box, box, {}, 0.0}, solid) &&
          !touch({&point, 1, path, &start, start, {}, 0.0}, solid))
        return true;
    }
    return false;
  }
  void put_back(int i, double time) {
    Pose pose = stride(i).at(time);
    pose.theta = into_range(wrap(pose.theta), world_.angle_low[i], world_.angle_high[i]);
    state_.pose[first_ + i] = pose;
    work_.contacts.touched[i] = 1;
  }

  const World& world_;
  State& state_;
  const int w_;
  Workspace& work_;
  Scene& scene_;
  const Bodies& bodies_;
  const Begun& begun_;
  const int first_;
  const Stride rest_{};
};

}  // namespace

void push_and_hold(const World& world, State& state, int w, Workspace& work, const Resolution& options,
                   const Begun& begun) {
  push_apart(world, state, w, work, options, nullptr);
  work.contacts.touched.resize(world.objects);
  Holder holder(world, state, w, work, begun);
  std::vector<Contact>&now = state.scenes[w].contacts, &all = work.contacts.held;
  const int solved = kMaxPairsSolved / static_cast<int>(work.contacts.pairs.size() + 1);
  const int rounds = std::min({kRounds, kRoundsOfStep / begun.parts, solved});
  for (int round = 0; holder.hold(); ++round) {
    if (round == rounds) return;
    if (round == 0) std::sort(now.begin(), now.end(), is_before);
    std::swap(all, now);
    push_apart(world, state, w, work, options, nullptr);
    merge_contacts(all, now, 1.0);
    std::swap(all, now);
  }
}

void merge_contacts(std::vector<Contact>& all, const std::vector<Contact>& now, double share) {
  const std::size_t known = all.size();
  for (const Contact& contact : now) {
    const auto same = std::lower_bound(all.begin(), all.begin() + known, contact, is_before);
    if (same == all.begin() + known || is_before(contact, *same)) {
      all.push_back(contact);
      all.back().force *= share;
      continue;
    }
    const double force = same->force + contact.force * share;
    if (contact.depth > same->depth) *same = contact;
    same->force = force;
  }
  if (all.size() > known) std::sort(all.begin(), all.end(), is_before);
}

}  // namespace irsim
