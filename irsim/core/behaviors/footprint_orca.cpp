// What an object with footprint_orca sees of others.
#include "behaviors/footprint_orca.hpp"

#include <algorithm>

#include "footprints/decider.hpp"
#include "geometry/predicates.hpp"
#include "orca/obstacles.hpp"
#include "world/features.hpp"

namespace irsim {
namespace {

constexpr double kLeastGap = 0.005;          // part of a gap that stays free [m]
constexpr double kLeastStandingGap = 0.001;  // gap that is kept from what stands [m]
constexpr double kOutlineDistance = 0.5;     // gap of bounding circles from which these stand for outlines [m]
constexpr double kRestingSpeed = 0.1;        // an arrived object that is slower rests [m/s]
constexpr double kStrangerDistance = 0.1;    // distance kept in addition from movers that do something else [m]
constexpr double kStrangerHorizons = 2.0;    // time horizon for them, in those of the options
constexpr double kWayReach = 5.0;            // half the side of the box in which static obstacles block a way [m]
constexpr double kRestingReach = 10.0;       // farther bodies that rest do not block a way [m]

bool sees_role(const World& world, int viewer, int other) {
  const int wanted = world.target_roles[viewer];
  return wanted == 0 || (wanted == 1) == (world.is_robot[other] != 0);
}

/// Make the outlines of all movers, and list those that rest.
void fill_crowd(const Decision& decision, const OrcaCrowd& all, FootprintCrowd& crowd) {
  const World& world = decision.world;
  const State& state = decision.state;
  const Shapes& shapes = *state.scenes[decision.w()].shapes;
  crowd.known = true;
  crowd.hulls.clear();
  crowd.resting.clear();
  for (const int i : world.moving) {
    const int row = decision.first_row + i;
    crowd.hulls.add(shapes, i, state.pose[row].position(), state.heading(row));
  }
  for (std::size_t m = 0; m < world.moving.size(); ++m) {
    const int i = world.moving[m], row = decision.first_row + i;
    const bool rests = state.arrived[row] && squared(all.movers[m].velocity) < kRestingSpeed * kRestingSpeed;
    if ((!state.stopped[row] && !rests) || state.absent(row)) continue;
    crowd.resting.push_back({crowd.hulls[static_cast<int>(m)], all.movers[m].position, shapes.radius[i]});
  }
}

FootprintSelf self_of(const FootprintOrcaOptions& options, const Decision& decision, int k, const OrcaCrowd& all,
                      FootprintCrowd& crowd) {
  const World& world = decision.world;
  const State& state = decision.state;
  const Shapes& shapes = *state.scenes[decision.w()].shapes;
  const int i = decision.objects[k], row = decision.row(k), mover = shapes.placed[i].object;
  const Drive& drive = world.drive[i];
  const Vec3& top = state.vel_max[row];
  const bool slides = std::holds_alternative<OmniOptions>(drive) || std::holds_alternative<OmniAngularOptions>(drive);
  const double own = slides ? std::min(top[0], top[1]) : top[0];
  const bool turns = !slides && !std::holds_alternative<AckerOptions>(drive);
  return {options,
          decision,
          all,
          crowd,
          i,
          row,
          mover,
          crowd.hulls[mover],
          state.pose[row].position(),
          all.movers[mover].velocity,
          state.heading(row),
          std::max(0.0, options.maxSpeed ? std::min(*options.maxSpeed * state.pace[row], own) : own),
          turns ? std::max(0.0, top[1]) : 0.0,
          slides,
          !slides && options.backward && state.vel_min[row][0] < 0.0,
          norm(shapes.centre[i]) + shapes.radius[i]};
}

/// Find the static obstacles near an object: threats, and blockers of its way.
void meet_static(FootprintSelf& self) {
  const World& world = self.world();
  const Obstacles& obstacles = self.state().scenes[self.decision.w()].fixed->obstacles;
  FootprintCrowd& crowd = self.crowd;
  crowd.blockers.clear();
  for (const Blocker& one : crowd.resting) {
    if (squared(one.centre - self.position) < kRestingReach * kRestingReach) crowd.blockers.push_back(one);
  }
  if (obstacles.empty()) return;
  crowd.walls.clear();
  const int edges = static_cast<int>(obstacles.edges.size());
  std::vector<int>& found = crowd.others;
  found.clear();
  const Vec2 centre = self.all.movers[self.mover].position;
  obstacles.near(box_around(centre, kWayReach), [&](int k) {
    const int object = k < edges ? obstacles.edges[k].object : obstacles.discs[k - edges].object;
    if (object < 0 || sees_role(world, self.object, object)) found.push_back(k);
  });
  std::sort(found.begin(), found.end());
  for (const int k : found) {
    if (k < edges) {
      crowd.walls.add(obstacles.edges[k].left.point, obstacles.edges[k].right.point);
    } else {
      crowd.walls.add(obstacles.discs[k - edges].centre, obstacles.discs[k - edges].radius);
    }
  }
  const double horizon = self.options.timeHorizonObst;
  const double reach = horizon * self.speed + 2.0 * self.stride() + self.all.movers[self.mover].radius;
  for (int n = 0; n < crowd.walls.count(); ++n) {
    const Hull wall = crowd.walls[n];
    const Vec2 a = wall.corner[0], b = wall.corner[wall.count - 1];
    crowd.blockers.push_back({wall, (a + b) * 0.5, 0.5 * norm(b - a) + wall.round});
    const int k = found[n];
    if (k < edges && !obstacles.edges[k].faces(centre)) continue;
    if (norm(nearest_on_segment(a, b, centre) - centre) - wall.round >= reach) continue;
    Threat threat{{}, 1.0, {}, horizon, true};
    const Separation apart = cone_of(self.hull, wall, self.options.safe_distance, false, crowd.faces, threat.cone);
    crowd.threats.push_back(threat);
    if (apart.gap < 2.0 * self.stride())
      crowd.cell.fixtures.push_back({wall, std::min(kLeastStandingGap, apart.gap), {}});
  }
}

/// List the movers that an object avoids.
void find_others(FootprintSelf& self, OrcaCrowd& all) {
  const World& world = self.world();
  std::vector<int>& likely = all.neighbors_before[self.mover];
  std::vector<int>& others = self.crowd.others;
  others.clear();
  const int most = std::min(self.options.maxNeighbors, static_cast<int>(all.movers.size()) - 1);
  if (most <= 0) return;
  const int group = all.member_of[self.mover];
  if (static_cast<int>(all.neighbors.size()) < most) all.neighbors.resize(most);
  const auto seen = [&](int m) {
    return m != self.mover && (all.member_of[m] == group || sees_role(world, self.object, world.moving[m]));
  };
  const Vec2 centre = all.movers[self.mover].position;
  const int count = all.nearest.find(centre, self.options.neighborDist, most, likely, seen, all.neighbors.data());
  for (int k = 0; k < count; ++k) others.push_back(all.neighbors[k].index);
  likely = others;
}

/// Meet a mover: a threat, and a border if it is near.
void meet_mover(FootprintSelf& self, int m) {
  const World& world = self.world();
  const OrcaCrowd& all = self.all;
  FootprintCrowd& crowd = self.crowd;
  const int theirs = all.group[m], other = self.decision.first_row + world.moving[m];
  const bool standing = self.state().stopped[other] != 0;
  const bool mutual =
      theirs >= 0 && (theirs == all.member_of[self.mover] || sees_role(world, world.moving[m], self.object));
  const bool alike = mutual && std::holds_alternative<FootprintOrcaOptions>(world.behaviors[theirs].behavior);
  const Vec2 moves = standing ? Vec2{} : all.movers[m].velocity;
  const double gain = mutual ? 2.0 : 1.0;
  const bool strange = !standing && !alike;
  const double margin = self.options.safe_distance + (strange ? kStrangerDistance : 0.0);
  const double horizon =
      standing ? self.options.timeHorizonObst : self.options.timeHorizon * (strange ? kStrangerHorizons : 1.0);
  Threat threat{{}, gain, self.velocity * (gain - 1.0) + moves, horizon, standing};
  const Shapes& shapes = *self.state().scenes[self.decision.w()].shapes;
  const Vec2 offset = all.movers[m].position - all.movers[self.mover].position;
  const double radii = shapes.radius[self.object] + shapes.radius[world.moving[m]] + margin;
  const double gap = norm(offset) - radii, stride = 2.0 * self.stride() + norm(moves) * world.step_time;
  if (gap > horizon * (gain * self.speed + norm(threat.base))) return;
  // Circles stand for bodies that are far, and for those whose way is not known as long as they do not overlap.
  const bool discs = strange ? gap > 0.0 : gap > std::max(kOutlineDistance, stride);
  const Hull body = crowd.hulls[m];
  Separation apart{{}, gap};
  if (discs) {
    cone_of(offset, radii, crowd.faces, threat.cone);
  } else {
    apart = cone_of(self.hull, body, margin, m < self.mover, crowd.faces, threat.cone);
  }
  crowd.threats.push_back(threat);
  if (apart.gap > 2.0 * stride) return;
  if (standing) {
    crowd.cell.fixtures.push_back({body, std::min(kLeastStandingGap, apart.gap), {}});
  } else if (!alike) {
    crowd.cell.fixtures.push_back({body, kLeastGap, moves * world.step_time});
  } else {
    const double own = std::max(0.0, -dot(apart.axis, self.velocity)), toward = std::max(0.0, dot(apart.axis, moves));
    crowd.cell.borders.push_back(border(self.hull, apart, own, toward, kLeastGap));
  }
}

}  // namespace

void footprint_orca(const FootprintOrcaOptions& options, const Decision& decision, Intent* intents) {
  OrcaCrowd& all = crowd(decision.world, decision.state, decision.work, decision.w());
  if (!all.outlines) all.outlines = std::make_shared<FootprintCrowd>();
  FootprintCrowd& outlines = *all.outlines;
  if (!outlines.known) fill_crowd(decision, all, outlines);
  for (int k = 0; k < decision.count; ++k) {
    FootprintSelf self = self_of(options, decision, k, all, outlines);
    outlines.threats.clear();
    outlines.faces.clear();
    outlines.cell.clear();
    meet_static(self);
    find_others(self, all);
    for (const int m : outlines.others) meet_mover(self, m);
    intents[k] = best_intent(self, wanted_velocity(self));
  }
}

}  // namespace irsim
