#include "surroundings/wall_view.hpp"

#include "geometry/predicates.hpp"
#include "surroundings/ego.hpp"

namespace irsim {
namespace {

constexpr double kOnTangent = 1e-9;  // directions this close to a tangent, as a sine, do not meet the ring

}  // namespace

Barrier::Barrier(Vec2 from, Vec2 to, double r)
    : a(from), b(to), nearest(nearest_on_segment(from, to, {})), radius(r), gap(norm(nearest) - r) {}

double Barrier::time(Vec2 w) const {
  if (!(dot(w, nearest) > 0.0)) return kInfinity;  // the disc moves away from the nearest point, and so from the wall
  if (gap <= 0.0) return 0.0;
  double first = kInfinity;
  const Vec2 edge = b - a;
  const double length = norm(edge);
  if (length > 0.0) {
    const double offset = cross(edge, a) / length, speed = cross(edge, w) / length;
    const double towards = offset > 0.0 ? speed : -speed;
    if (towards > 0.0) {
      const double t = (std::fabs(offset) - radius) / towards;
      const double at = dot(w * t - a, edge);
      if (t >= 0.0 && at >= 0.0 && at <= length * length) first = t;
    }
  }
  for (const Vec2 end : {a, b}) {
    const double along = dot(w, end), speed2 = squared(w);
    const double root = along * along - speed2 * (squared(end) - radius * radius);
    if (along > 0.0 && root >= 0.0) first = std::min(first, std::max((along - std::sqrt(root)) / speed2, 0.0));
  }
  return first;
}

bool WallView::blocks(Vec2 w, double horizon, double share) const {
  if (fronts.empty()) return false;
  const double speed = norm(w);
  for (const Front& front : fronts) {
    if (!front.everywhere && !front.tangents.hold(w)) continue;
    const double look = front.look * share, limit = look > horizon * speed ? look / speed : horizon;
    for (int k = front.first; k < front.last; ++k)
      if (barriers[k].time(w) < limit) return true;
  }
  return false;
}

const Front* WallView::in_the_way(Vec2 w, double share) const {
  for (const Front& front : fronts) {
    if (!(front.look > 0.0) || !front.tangents.hold(w, kOnTangent)) continue;
    for (int k = front.first; k < front.last; ++k)
      if (barriers[k].time(w) < front.look * share) return &front;
  }
  return nullptr;
}

void add_walls(const Decision& decision, int id, Vec2 position, double radius, double reach, double look, double margin,
               bool all, WallView& view) {
  const Walls& walls = decision.state.scenes[decision.w()].fixed->walls;
  const Ring* ring = nullptr;
  for_facing_walls(decision, id, position, std::max(reach, look > 0.0 ? look + radius : 0.0), [&](const Wall& wall) {
    if (!all && decision.world.unobstructed[wall.object]) return;
    const Barrier barrier(wall.a - position, wall.b - position, radius);
    if (ring != &walls.rings[wall.ring]) {
      ring = &walls.rings[wall.ring];
      Front front;
      front.first = front.last = static_cast<int>(view.barriers.size());
      const double distance = ring->can_be_passed() ? ring->distance(position) : 0.0;
      if (distance > 0.0) {
        front.everywhere = distance <= radius + margin;
        front.tangents = ring->tangents(position, distance, radius + margin);
        front.look = look;
        front.farthest = ring->farthest(position);
        view.passable = view.passable || look > 0.0;
      }
      view.fronts.push_back(front);
    }
    if (!(view.fronts.back().look > 0.0) && barrier.gap > reach - radius) return;
    view.barriers.push_back(barrier);
    view.fronts.back().last += 1;
  });
}

}  // namespace irsim
