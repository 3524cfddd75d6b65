#include "sensing/view.hpp"

#include "geometry/sector.hpp"
#include "phases.hpp"
#include "sensing.hpp"
#include "sensing/raycast.hpp"
#include "world/workspace.hpp"

namespace irsim {
namespace {

/// Bearings, relative to the axis of a sector, at which the visibility of an object may change.
class Bearings {
 public:
  /// Start with the ends of the part of a sector through which a disc about the target is seen.
  Bearings(const Sector& sector, Vec2 centre, double radius) : sector_(sector), axis_(unit(sector.middle)) {
    list_ = {-std::min(sector.half, kPi), std::min(sector.half, kPi)};
    const double distance = norm(centre - sector.apex);
    if (!(distance > radius * (1.0 + 1e-6))) return;
    target_ = bearing_of(centre), width_ = std::asin(radius / distance) + 1e-6;
    for (const double end : {wrap(target_ - width_), wrap(target_ + width_)}) {
      if (std::fabs(end) < sector.half) list_.push_back(end);
    }
  }

  void add(Vec2 point) {
    const double bearing = bearing_of(point);
    if (std::fabs(bearing) < sector_.half && std::fabs(wrap(bearing - target_)) <= width_) list_.push_back(bearing);
  }
  /// Add the bearings of corners and the outermost bearings of circles.
  void add_ends(const Footprint& body) {
    for (int k = 0; k < body.count; ++k) {
      const Part& part = body.parts[k];
      if (part.cells != nullptr) {
        near_cells(*part.cells, [&](Vec2 a, Vec2) { add(a); });
        continue;
      }
      if (part.kind != Kind::circle) {
        for (int v = part.first; v <= part.last; ++v) add(body.vertices[v]);
        continue;
      }
      const Vec2 centre = body.vertices[part.first], d = centre - sector_.apex;
      const double distance2 = squared(d), tangent2 = distance2 - part.radius * part.radius;
      if (!(tangent2 > 0.0)) continue;
      const double along = tangent2 / distance2, aside = part.radius * std::sqrt(tangent2) / distance2;
      add(sector_.apex + d * along + Vec2{-d.y, d.x} * aside);
      add(sector_.apex + d * along - Vec2{-d.y, d.x} * aside);
    }
  }
  /// Add the bearings at which boundaries cross.
  void add_crossings(const Footprint& a, const Footprint& b) {
    for (int i = 0; i < a.count; ++i) {
      for (int j = 0; j < b.count; ++j) cross_parts(a, a.parts[i], b, b.parts[j]);
    }
  }
  /// Add the bearings at which a boundary leaves the reach of the sector.
  void add_rim(const Footprint& body) {
    for (int k = 0; k < body.count; ++k) {
      const Part& part = body.parts[k];
      if (part.cells != nullptr) {
        near_cells(*part.cells, [&](Vec2 a, Vec2 b) { segment_circle(a, b, sector_.apex, sector_.reach); });
      } else if (part.kind == Kind::circle) {
        circles(body.vertices[part.first], part.radius, sector_.apex, sector_.reach);
      } else {
        for (int v = part.first; v < part.last; ++v) {
          segment_circle(body.vertices[v], body.vertices[v + 1], sector_.apex, sector_.reach);
        }
      }
    }
  }
  /// All bearings, in ascending order.
  const std::vector<double>& sorted() {
    std::sort(list_.begin(), list_.end());
    return list_;
  }

 private:
  double bearing_of(Vec2 point) const {
    const Vec2 p = unrotate(point - sector_.apex, axis_);
    return std::atan2(p.y, p.x);
  }
  /// Visit the edges between occupied and free cells within reach, in both directions.
  template <class Visit>
  void near_cells(const OccupancyGrid& grid, Visit&& visit) const {
    grid.any_in(box_around(sector_.apex, sector_.reach), [&](int i, int j) {
      const Vec2 corners[4] = {grid.corner(i, j), grid.corner(i + 1, j), grid.corner(i + 1, j + 1),
                               grid.corner(i, j + 1)};
      const bool free[4] = {!grid.occupied(i, j - 1), !grid.occupied(i + 1, j), !grid.occupied(i, j + 1),
                            !grid.occupied(i - 1, j)};
      for (int k = 0; k < 4; ++k) {
        if (free[k]) visit(corners[k], corners[(k + 1) % 4]), visit(corners[(k + 1) % 4], corners[k]);
      }
      return false;
    });
  }
  void cross_cells(const OccupancyGrid& grid, const Footprint& b, const Part& q) {
    near_cells(grid, [&](Vec2 from, Vec2 to) {
      if (q.kind == Kind::circle) return segment_circle(from, to, b.vertices[q.first], q.radius);
      for (int j = q.first; j < q.last; ++j) segments(from, to, b.vertices[j], b.vertices[j + 1]);
    });
  }
  void cross_parts(const Footprint& a, const Part& p, const Footprint& b, const Part& q) {
    if (p.cells != nullptr) return cross_cells(*p.cells, b, q);
    if (q.cells != nullptr) return cross_cells(*q.cells, a, p);
    const bool round_p = p.kind == Kind::circle, round_q = q.kind == Kind::circle;
    if (round_p && round_q) return circles(a.vertices[p.first], p.radius, b.vertices[q.first], q.radius);
    if (round_p) return cross_parts(b, q, a, p);
    for (int i = p.first; i < p.last; ++i) {
      const Vec2 from = a.vertices[i], to = a.vertices[i + 1];
      if (round_q) {
        segment_circle(from, to, b.vertices[q.first], q.radius);
        continue;
      }
      for (int j = q.first; j < q.last; ++j) segments(from, to, b.vertices[j], b.vertices[j + 1]);
    }
  }
  void segments(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
    const Vec2 along = b - a, other = d - c;
    const double den = cross(along, other);
    if (den == 0.0) return;
    const double t = cross(c - a, other) / den, s = cross(c - a, along) / den;
    if (t >= 0.0 && t <= 1.0 && s >= 0.0 && s <= 1.0) add(a + along * t);
  }
  void segment_circle(Vec2 a, Vec2 b, Vec2 centre, double radius) {
    const Vec2 along = b - a, from = a - centre;
    const double aa = squared(along), ab = dot(from, along), root2 = ab * ab - aa * (squared(from) - radius * radius);
    if (!(aa > 0.0 && root2 >= 0.0)) return;
    for (const double root : {-std::sqrt(root2), std::sqrt(root2)}) {
      const double t = (-ab + root) / aa;
      if (t >= 0.0 && t <= 1.0) add(a + along * t);
    }
  }
  void circles(Vec2 a, double ra, Vec2 b, double rb) {
    const Vec2 d = b - a;
    const double distance2 = squared(d);
    if (!(distance2 > 0.0)) return;
    const double along = 0.5 * (distance2 + ra * ra - rb * rb) / distance2;
    const double aside2 = ra * ra / distance2 - along * along;
    if (!(aside2 >= 0.0)) return;
    const Vec2 aside = Vec2{-d.y, d.x} * std::sqrt(aside2);
    add(a + d * along + aside);
    add(a + d * along - aside);
  }

  const Sector& sector_;
  Vec2 axis_;
  double target_ = 0.0, width_ = kInfinity;  // bearing and half width of the target [rad]
  std::vector<double> list_;
};

/// Whether a point lies inside a closed footprint.
bool contains(const Footprint& body, Vec2 p) { return meets(body, {p, 0.0, kPi, 0.0}); }

/// One beam between each two neighboring bearings: it sees what is visible from one bearing to the next.
Mount beams_between(const std::vector<double>& bearings) {
  Mount mount{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, {}, {}, {}, {}};
  mount.angle.push_back(0.0);  // two equal angles mark beams that are not evenly spaced
  mount.angle.push_back(0.0);
  for (std::size_t k = 1; k < bearings.size(); ++k) {
    if (bearings[k] - bearings[k - 1] > 1e-12) mount.angle.push_back(0.5 * (bearings[k - 1] + bearings[k]));
  }
  mount.count = static_cast<int>(mount.angle.size());
  return mount;
}

/// Where one looks from, along which axis, and how far.
struct Outlook {
  Vec2 eye, axis;
  double reach;
};

/// Of the beams that hit a target if it is alone: how many there are, and how many of them nothing stops before.
struct BeamCount {
  int whole = 0, open = 0;
};

/// Cast the beams of `beams_between` at a target, and at what may stand before it.
BeamCount look_at(const World& world, const State& state, int w, int target, const std::vector<int>& blockers,
                  const Outlook& from, const Mount& mount, BeamBuffers& buffers, BeamBuffers& spare) {
  Fan seen(buffers, from.eye, from.axis, mount, from.reach), before(spare, from.eye, from.axis, mount, from.reach);
  for (int k = 0; k < mount.count; ++k) {
    const Vec2 beam = rotate(unit(mount.angle[k]), from.axis);
    seen.aim(k, beam), before.aim(k, beam);
  }
  const auto consider = [&](Fan& fan, int i) {
    const auto [centre, radius] = state.bounds(world, w, i);
    fan.consider(i, centre, radius);
  };
  const auto footprint = [&](int i) { return state.footprint(world, w, i); };
  consider(seen, target);
  seen.cast(footprint);
  for (const int i : blockers) consider(before, i);
  before.cast(footprint);
  BeamCount count;
  for (int k = 2; k < mount.count; ++k) {
    if (seen.hit(k) < 0) continue;
    ++count.whole;
    count.open += !(before.hit(k) >= 0 && before.range(k) < seen.range(k) * (1.0 - 1e-12));
  }
  return count;
}

/// Whether some part of `target` in the sector is not hidden from the apex by other objects.
bool is_partly_visible(const World& world, const State& state, int w, int object, int target, const Sector& sector,
                       Workspace& work) {
  const Footprint body = state.footprint(world, w, target);
  if (contains(body, sector.apex)) return true;
  const double far = norm(body.centre - sector.apex) + body.radius;
  std::vector<int> blockers;
  for (const int i : world.visible) {
    if (i == object || i == target) continue;
    const auto [centre, radius] = state.bounds(world, w, i);
    const double distance = norm(centre - sector.apex);
    if (!(distance - radius <= std::min(far, sector.reach))) continue;
    const double between = std::fabs(cross(centre - sector.apex, body.centre - sector.apex));
    const bool aside = distance > radius && far > 2.0 * body.radius &&
                       std::asin(radius / distance) + std::asin(body.radius / (far - body.radius)) <
                           std::atan2(between, dot(centre - sector.apex, body.centre - sector.apex)) - 1e-9;
    if (!aside) blockers.push_back(i);
  }
  if (blockers.empty()) return true;
  Bearings bearings(sector, body.centre, body.radius);
  bearings.add_ends(body);
  bearings.add_rim(body);
  for (const int i : blockers) {
    const Footprint blocker = state.footprint(world, w, i);
    bearings.add_ends(blocker);
    if (blocker.box.meets(body.box)) bearings.add_crossings(body, blocker);
  }
  const Mount mount = beams_between(bearings.sorted());
  return look_at(world, state, w, target, blockers, {sector.apex, unit(sector.middle), sector.reach}, mount, work.beams,
                 work.blockers)
             .open > 0;
}

}  // namespace

bool sees(const World& world, const State& state, int w, const View& view, int target, Workspace& work) {
  if (!(view.angle >= 0.0 && view.reach >= 0.0)) return false;
  if (state.absent(w * world.objects + view.object) || state.absent(w * world.objects + target)) return false;
  const Pose& pose = state.pose[w * world.objects + view.object];
  const Sector sector{pose.position(), pose.theta, view.angle >= kTurn ? kPi : 0.5 * view.angle, view.reach};
  if (target == view.object || !meets(state.footprint(world, w, target), sector)) return false;
  return !view.occlusion || is_partly_visible(world, state, w, view.object, target, sector, work);
}

std::vector<int> in_view(const World& world, State& state, int w, const View& view, Workspace& work) {
  place_moving(world, state, w);
  std::vector<int> seen;
  for (int i = 0; i < world.objects; ++i) {
    if (sees(world, state, w, view, i, work)) seen.push_back(i);
  }
  return seen;
}

double visible_share(const Sensing& s, Vec2 eye, int target) {
  constexpr int kBeams = 21;
  const auto [centre, radius] = s.bounds(target);
  const double distance = norm(centre - eye);
  if (distance <= radius) return 1.0;
  const double half = std::asin(radius / distance);
  std::vector<double> bearings;
  for (int k = 0; k <= kBeams; ++k) bearings.push_back(half * (2.0 * k / kBeams - 1.0));
  std::vector<int> blockers;
  for (const int i : s.world.visible) {
    if (i != s.mount.object && i != target) blockers.push_back(i);
  }
  const BeamCount count =
      look_at(s.world, s.state, s.w, target, blockers, {eye, (centre - eye) * (1.0 / distance), distance + radius},
              beams_between(bearings), s.buffers, s.spare);
  return count.whole > 0 ? static_cast<double>(count.open) / count.whole : 0.0;
}

}  // namespace irsim
