// Whether pushing bodies apart at the end of a step would let one of them come out on the far side of another.
#include <algorithm>

#include "collision/touch.hpp"
#include "contact/near.hpp"
#include "contact/parts.hpp"
#include "contact/solver.hpp"
#include "phases.hpp"
#include "phases/strides.hpp"

namespace irsim {
namespace {

constexpr double kPart = 0.25;      // share of the widths of two bodies by which they move in a part of a step
constexpr double kCorners = 0.25;   // share of these widths by which their corners may swing unseen
constexpr int kMostParts = 4000;    // of a step
constexpr int kMostPairs = 800000;  // of near bodies, in all parts of a step; larger crowds move in fewer parts

class FastBodies {
 public:
  FastBodies(const World& world, State& state, int w, Workspace& work)
      : world_(world),
        state_(state),
        w_(w),
        work_(work),
        buffers_(work.contacts),
        scene_(state.scenes[w]),
        bodies_(bodies_of(world, state, w)),
        first_(w * world.objects) {}

  int parts() {
    buffers_.strides.clear();
    double far = 0.0;
    for (const int i : world_.moving) {
      buffers_.strides.push_back(stride_of(world_, state_, w_, i));
      far = std::max(far, swing(i, buffers_.strides.back()) + norm(buffers_.strides.back().by));
    }
    thinnest_ = bodies_.lightest + bodies_.thinnest;
    if (!(2.0 * far > std::min(kFast * thinnest_, bodies_.lightest))) return 1;
    return examine(far);
  }

 private:
  /// How far the turn and the bend of its way carry the sides of a body out of the straight motion of its origin [m].
  double swing(int object, const Stride& stride) const {
    const double way = way_of_turn(*scene_.shapes, bodies_, object, stride.turn);
    return std::isfinite(stride.by.x + stride.by.y) ? way + 2.0 * stride.bulge(0.0) : 0.0;
  }
  Stride stride(int i) const {
    if (world_.is_static[i]) return Stride::resting(state_.pose[first_ + i]);
    return buffers_.strides[scene_.shapes->placed[i].object];
  }
  /// How far sides of two bodies may move past each other in the step [m]. The corners of compact bodies do not count.
  double way_between(int a, int b) const {
    const Stride one = stride(a), other = stride(b);
    return norm(one.by - other.by) + std::max(0.0, swing(a, one) + swing(b, other) - kCorners * width(a, b));
  }
  double width(int a, int b) const { return bodies_.width[a] + bodies_.width[b]; }
  /// How far two bodies must move past each other to pass, or for one that can be pushed to go in and out again [m].
  double fast_way(int a, int b) const {
    double least = kFast * width(a, b);
    for (const int i : {a, b}) {
      if (world_.dynamics[i].pushable) least = std::min(least, bodies_.width[i]);
    }
    return least;
  }
  bool is_whole(int i) const { return bodies_.cells[i] == nullptr && bodies_.begin[i + 1] == bodies_.begin[i] + 1; }

  /// The pairs of objects whose boxes in the step come within `reach` of each other, and of which one can be pushed.
  void find_near(double reach) {
    bound_steps(world_, state_, w_, scene_.ways);
    const auto grown_by = [&](double by) {
      return [this, by](int i) { return grown(scene_.ways[scene_.shapes->placed[i].object], by); };
    };
    near_pairs(world_, scene_, grown_by(reach), grown_by(0.5 * reach), true, buffers_.met);
  }
  /// List the near objects of each object.
  void link() {
    if (linked_) return;
    linked_ = true;
    std::vector<int>&first = buffers_.first_link, &next = buffers_.distance;
    first.assign(world_.objects + 1, 0);
    for (const auto& [a, b] : buffers_.met) ++first[a], ++first[b];
    int sum = 0;
    for (int& begin : first) sum += begin, begin = sum - begin;
    next.assign(first.begin(), first.end());
    buffers_.links.resize(2 * buffers_.met.size());
    for (const auto& [a, b] : buffers_.met) buffers_.links[next[a]++] = b, buffers_.links[next[b]++] = a;
  }

  int examine(double far) {
    scene_.parted.clear(), scene_.bent.clear();
    place_moving(world_, state_, w_);
    find_near(far);
    const std::vector<std::pair<int, int>>& near = buffers_.met;
    const int most = std::min(kMostParts, kMostPairs / std::max(1, static_cast<int>(near.size())));
    if (most * kPart < kFast) return 1;
    const Resolution any{0, 0, 0.0, world_.step_time};
    ContactSolver solver(world_, state_, w_, work_, any);
    solver.place_moving();
    for (const auto& [a, b] : near) {
      if (share_ >= most * kPart) break;
      const double way = way_between(a, b);
      if (!std::isfinite(way)) continue;
      if (way > fast_way(a, b) && comes_out_elsewhere(solver, a, b, way)) {
        share_ = std::max(share_, kFast * way / fast_way(a, b));
      } else if (way > kFast * thinnest_) {
        push_apart(solver, a, b);
      }
    }
    if (!(share_ > kFast)) return 1;
    return static_cast<int>(clip(std::ceil(share_ / kPart), 2.0, most));
  }

  /// Whether two bodies meet in the step, but are pushed apart at its end in another direction, or not at all. The
  /// first pushes the second one before it then.
  bool comes_out_elsewhere(ContactSolver& solver, int a, int b, double way) {
    const Stride one = stride(a), other = stride(b);
    const Passage passage(world_, state_, w_, a, b);
    Vec2 where;
    const bool touch = passage.in_contact(0.0);
    if (!touch && !come_near(world_, state_, w_, a, b)) return false;
    const double when = touch ? 0.0 : passage.first_contact(0.0, 1.0, where);
    if (!(when <= 1.0)) return false;
    const Pose at_a = one.at(when), at_b = other.at(when);
    const Overlap first = solver.overlap_at(a, b, at_a, at_b);
    const auto moved = [&](const Pose& from, const Pose& to) {
      return to.position() + rotate(first.point - from.position(), unit(to.theta - from.theta)) - first.point;
    };
    const Vec2 push_b = moved(at_a, one.at(1.0)), push_a = moved(at_b, other.at(1.0));
    const bool whole = is_whole(a) && is_whole(b);
    const double closing = -dot(first.normal, push_b - push_a);
    if (touch && whole && closing <= 0.0) return false;  // they part
    const Overlap last = solver.overlap_at(a, b, one.at(1.0), other.at(1.0));
    if (std::isfinite(last.depth)) {
      if (!((1.0 - when) * way > kFast * width(a, b))) return false;
      const bool swings = swing(a, one) + swing(b, other) > kFast * width(a, b);
      if (!swings && whole && dot(first.normal, last.normal) > 0.0) return false;
    }
    const Vec2 back = first.normal * std::max(0.0, closing);
    push_on(a, at_a, push_a, b), push_on(a, at_a, push_b + back, b);
    push_on(b, at_b, push_b, a), push_on(b, at_b, push_a - back, a);
    return true;
  }
  /// Look for thin bodies that one of these two, pushed away at the end of the step, would be pushed through then, or
  /// on its way past the other one.
  void push_apart(ContactSolver& solver, int a, int b) {
    const Pose &at_a = state_.pose[first_ + a], &at_b = state_.pose[first_ + b];
    const Overlap last = solver.overlap_at(a, b, at_a, at_b);
    if (!(last.depth > kFast * thinnest_)) return;
    const Vec2 back = last.normal * last.depth;
    const Stride one = stride(a), other = stride(b);
    push_on(a, at_a, back, b), push_on(a, one.from, one.by + back, b);
    push_on(b, at_b, back * -1.0, a), push_on(b, other.from, other.by - back, a);
  }
  /// Look for thin bodies that a body would be pushed through by another one, or would push other bodies through.
  void push_on(int body, const Pose& from, Vec2 push, int by) {
    const double way = norm(push);
    if (!world_.dynamics[body].pushable || !(way > kFast * thinnest_)) return;
    link();
    buffers_.reached.assign(world_.objects, 0);
    buffers_.reached[body] = buffers_.reached[by] = 1;
    buffers_.queue.assign(1, body);
    for (std::size_t head = 0; head < buffers_.queue.size(); ++head) {
      const int now = buffers_.queue[head];
      const Pose at = now == body ? from : state_.pose[first_ + now];
      scene_.trial.resize(scene_.shapes->size[0]);
      scene_.trial.place(*scene_.shapes, now, at, unit(at.theta));
      for (int k = buffers_.first_link[now]; k < buffers_.first_link[now + 1]; ++k) {
        const int next = buffers_.links[k];
        if (buffers_.reached[next] || !meets(now, at, push, next)) continue;
        buffers_.reached[next] = 1;
        if (way > kFast * width(now, next))
          share_ = std::max(share_, (way + way_between(now, next)) / width(now, next));
        if (world_.dynamics[next].pushable) buffers_.queue.push_back(next);
      }
    }
  }
  /// Whether a body, put into `Scene::trial` at a pose, meets another one on its way from there.
  bool meets(int body, const Pose& from, Vec2 push, int next) {
    const Footprint here = scene_.trial.footprint(*scene_.shapes, body), there = state_.footprint(world_, w_, next);
    Box way = here.box;
    way.include({way.x0 + push.x, way.y0 + push.y, way.x1 + push.x, way.y1 + push.y});
    if (!way.meets(there.box)) return false;
    const Moving pushed = moving_body(*scene_.shapes, body, {from, push});
    Vec2 where;
    return touch(here, there) || first_contact(pushed, resting_body(there), 0.0, 1.0, scene_.swept, where) <= 1.0;
  }

  const World& world_;
  State& state_;
  const int w_;
  Workspace& work_;
  ContactBuffers& buffers_;
  Scene& scene_;
  const Bodies& bodies_;
  const int first_;
  bool linked_ = false;
  double thinnest_ = kInfinity;  // least width of two bodies that can meet
  double share_ = 0.0;           // largest of those ways through which a body would pass another, in their widths
};

}  // namespace

int parts_of_step(const World& world, State& state, int w, Workspace& work) {
  return state.scenes[w].in_motion ? FastBodies(world, state, w, work).parts() : 1;
}

}  // namespace irsim
