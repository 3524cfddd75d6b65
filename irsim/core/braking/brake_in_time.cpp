#include "braking/brake_in_time.hpp"

#include <algorithm>

#include "braking/stops.hpp"
#include "geometry/predicates.hpp"
#include "surroundings/ego.hpp"
#include "world/features.hpp"
#include "world/spec.hpp"

namespace irsim {
namespace {

constexpr double kMargin = 0.01;                              // part of a gap that stays free [m]
constexpr double kRounding = 1e-9;                            // [m]
constexpr double kShares[] = {1.0, 0.8, 0.6, 0.4, 0.2, 0.0};  // of the wanted speed, tried in this order

/// The nearest points of two segments.
std::pair<Vec2, Vec2> nearest_points(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const double denominator = cross(b - a, d - c);
  if (denominator != 0.0) {
    const double s = cross(c - a, d - c) / denominator, t = cross(c - a, b - a) / denominator;
    if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0) return {a + (b - a) * s, a + (b - a) * s};
  }
  std::pair<Vec2, Vec2> best{a, nearest_on_segment(c, d, a)};
  const auto offer = [&](Vec2 p, Vec2 q) {
    if (squared(q - p) < squared(best.second - best.first)) best = {p, q};
  };
  offer(b, nearest_on_segment(c, d, b));
  offer(nearest_on_segment(a, b, c), c);
  offer(nearest_on_segment(a, b, d), d);
  return best;
}

/// Largest dot(normal, p) of points.
double farthest(const Vec2* points, int count, Vec2 normal) {
  double most = -kInfinity;
  for (int k = 0; k < count; ++k) most = std::max(most, dot(points[k], normal));
  return most;
}

class Borders {
 public:
  Borders(const Decision& decision, int k)
      : decision_(decision),
        object_(decision.objects[k]),
        row_(decision.row(k)),
        all_(stops(decision.world, decision.state, decision.work, decision.w())) {
    all_.borders.clear();
    self_ = decision.state.scenes[decision.w()].shapes->placed[object_].object;
    const Stop& own = all_.of[self_];
    way_ = &all_.points[own.first];
    from_ = way_[0], to_ = way_[own.count - 1];
    const World& world = decision.world;
    const Vec3& top = decision.state.vel_max[row_];
    const double acce = decision.state.acce[row_][0], dt = world.step_time;
    speed_ = std::max(std::fabs(top[0]), std::fabs(decision.state.vel_min[row_][0]));
    reach_ = norm(to_ - from_) + own.bulge + 2.0 * speed_ * dt + (std::isfinite(acce) ? acce * dt * dt : speed_ * dt);
  }

  void add_movers() {
    const World& world = decision_.world;
    const Shapes& shapes = *decision_.state.scenes[decision_.w()].shapes;
    const Stop& own = all_.of[self_];
    for (std::size_t m = 0; m < all_.of.size(); ++m) {
      const int other = world.moving[m];
      if (shapes.parts[shapes.body[other].part].kind == Kind::linestring) continue;  // its circle is mostly empty
      if (other == object_ || world.unobstructed[other] || !is_shown(decision_, object_, other)) continue;
      const Stop& stop = all_.of[m];
      const Vec2* there = &all_.points[stop.first];
      const double most = reach_ + own.radius + stop.radius + kMargin;
      const Vec2 its = there[stop.count - 1];
      if (norm(there[0] - from_) > most + norm(its - there[0]) + stop.bulge + reach_) continue;
      const auto [p, q] = nearest_points(from_, to_, there[0], its);
      Vec2 normal = q - p;
      double length = norm(normal);
      if (!(length > 0.0)) normal = there[0] - from_, length = norm(normal);
      if (!(length > 0.0)) continue;
      normal = normal * (1.0 / length);
      const double mine = farthest(way_, own.count, normal) + own.radius;
      const double theirs = -farthest(there, stop.count, normal * -1.0) - stop.radius;
      const double gap = std::max(0.0, theirs - mine - kMargin);
      add(normal, mine + (stop.plans ? 0.5 * gap : gap));
    }
  }

  void add_static() {
    const Obstacles& obstacles = decision_.state.scenes[decision_.w()].fixed->obstacles;
    if (obstacles.empty()) return;
    const Stop& own = all_.of[self_];
    const int edges = static_cast<int>(obstacles.edges.size());
    const double reach = reach_ + own.radius + kMargin;
    const auto keep_off = [&](Vec2 p, Vec2 q, double radius) {
      Vec2 normal = q - p;
      const double length = norm(normal);
      if (!(length > 0.0)) return;
      normal = normal * (1.0 / length);
      const double mine = farthest(way_, own.count, normal) + own.radius;
      add(normal, mine + std::max(0.0, dot(q, normal) - radius - mine - kMargin));
    };
    obstacles.near(box_around(from_, reach), [&](int k) {
      if (k >= edges) {
        const StaticDisc& disc = obstacles.discs[k - edges];
        if (norm(disc.centre - from_) - disc.radius > reach || !is_shown(decision_, object_, disc.object)) return;
        return keep_off(nearest_on_segment(from_, to_, disc.centre), disc.centre, disc.radius);
      }
      const Edge& edge = obstacles.edges[k];
      if ((!edge.faces(from_) && !edge.faces(to_)) || (edge.object >= 0 && !is_shown(decision_, object_, edge.object)))
        return;
      const auto [p, q] = nearest_points(from_, to_, edge.left.point, edge.right.point);
      if (norm(q - from_) <= reach + norm(to_ - from_)) keep_off(p, q, 0.0);
    });
  }

  /// Whether the object can stop on its side of all borders after a period with this control.
  bool allows(const Vec3& control) {
    stop_after(decision_.world, decision_.state, row_, object_, control, all_.extra, all_.trial);
    const double radius = all_.of[self_].radius;
    return std::all_of(all_.borders.begin(), all_.borders.end(), [&](const Stops::Border& border) {
      return farthest(all_.trial.data(), static_cast<int>(all_.trial.size()), border.normal) + radius <=
             border.offset + kRounding;
    });
  }
  bool empty() const { return all_.borders.empty(); }

 private:
  void add(Vec2 normal, double offset) { all_.borders.push_back({normal, offset}); }

  const Decision& decision_;
  const int object_, row_;
  Stops& all_;
  int self_;
  const Vec2* way_;
  Vec2 from_, to_;
  double speed_, reach_;
};

}  // namespace

void brake_in_time(const Decision& decision, int k, Vec3& command) {
  const World& world = decision.world;
  const int object = decision.objects[k], row = decision.row(k);
  if (!is_inert(world, decision.state, row, object)) return;
  if (decision.state.route_of(row) != nullptr) return;
  Borders borders(decision, k);
  borders.add_movers();
  borders.add_static();
  if (borders.empty()) return;
  const Drive& drive = world.drive[object];
  int travel = 1;
  with(drive, [&](const auto& options) { travel = rows(options).travel; });
  for (const double share : kShares) {
    Vec3 slower = command;
    for (int c = 0; c < travel; ++c) slower[c] *= share;
    if (!borders.allows(slower)) continue;
    command = slower;
    return;
  }
  command = braking_control(drive, decision.state.control[row][1]);
}

}  // namespace irsim
