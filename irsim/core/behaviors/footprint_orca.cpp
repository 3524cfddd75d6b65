// The other objects, as one with footprint_orca sees them.
#include "behaviors/footprint_orca.hpp"

#include <algorithm>

#include "footprints/decider.hpp"
#include "geometry/predicates.hpp"
#include "orca/obstacles.hpp"
#include "surroundings/goal_heading.hpp"
#include "world/features.hpp"

namespace irsim {
namespace {

constexpr double kOutlineDistance = 0.5;   // gap of bounding circles from which these stand for outlines [m]
constexpr double kRestingSpeed = 0.1;      // an arrived object that is slower rests [m/s]
constexpr double kStrangerDistance = 0.1;  // distance kept in addition from movers that do something else [m]
constexpr double kStrangerHorizons = 2.0;  // time horizon for them, in time horizons of the options
constexpr double kWayReach = 5.0;          // half the side of the box in which static obstacles block a way [m]
constexpr double kRestingReach = 10.0;     // farther bodies that rest do not block a way [m]

bool sees_role(const World& world, int viewer, int other) {
  const int wanted = world.target_roles[viewer];
  return wanted == 0 || (wanted == 1) == (world.is_robot[other] != 0);
}

/// Make the outlines of all movers, and list the resting ones.
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
  fill_reaches(decision, all, crowd);
  for (std::size_t m = 0; m < world.moving.size(); ++m) {
    const int i = world.moving[m], row = decision.first_row + i;
    const bool rests = state.arrived[row] && squared(all.movers[m].velocity) < kRestingSpeed * kRestingSpeed;
    if ((!state.stopped[row] && !rests) || state.absent(row)) continue;
    crowd.resting.push_back({crowd.hulls[static_cast<int>(m)], all.movers[m].position, shapes.radius[i]});
  }
}

/// Largest speed from which the object can stop at a goal at which it must turn [m/s]; infinite at other times.
double approach_speed(const World& world, const State& state, int row, int object) {
  const double left = norm(state.goal[row].position() - state.pose[row].position());
  const bool brakes = turns_in_place(world.drive[object]) && turns_at_goal(world, state, row, object) &&
                      left >= world.goal_threshold[object];
  return brakes ? speed_to_goal(world, state, row) : kInfinity;
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
  const double own = std::min(slides ? std::min(top[0], top[1]) : top[0], approach_speed(world, state, row, i));
  const double reach = norm(shapes.centre[i]) + shapes.radius[i];
  const bool turns = !slides && !steers(drive);
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
          reach,
          {world, state, row, i, reach, crowd.extra}};
}

/// Find the static obstacles near an object: threats, and blockers of its way.
void meet_static(FootprintSelf& self) {
  const World& world = self.world();
  const Fixed& fixed = *self.state().scenes[self.decision.w()].fixed;
  const Obstacles& obstacles = fixed.obstacles;
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
  const double radius = self.all.movers[self.mover].radius, range = self.limits().range + radius;
  obstacles.near(box_around(centre, std::max(kWayReach, range)), [&](int k) {
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
  Sight sight(fixed.walls, centre);
  const double horizon = self.options.timeHorizonObst;
  const double reach = horizon * self.speed + 2.0 * self.stride() + radius;
  for (int n = 0; n < crowd.walls.count(); ++n) {
    const Hull wall = crowd.walls[n];
    const Vec2 a = wall.corner[0], b = wall.corner[wall.count - 1];
    crowd.blockers.push_back({wall, (a + b) * 0.5, 0.5 * norm(b - a) + wall.round});
    const int k = found[n];
    const bool faces = k >= edges || sight.sees(obstacles.edges[k]);
    const double distance = norm(nearest_on_segment(a, b, centre) - centre) - wall.round;
    if (faces && distance < reach) {
      Threat threat{{}, 1.0, {}, horizon, true};
      const Separation apart = cone_of(self.hull, wall, self.options.safe_distance, false, crowd.faces, threat.cone);
      crowd.threats.push_back(threat);
      bound_by_wall(self, wall, apart);
    } else if (distance < range && self.limits().glides) {  // it may get round a corner until it stands
      bound_by_wall(self, wall, separation(self.hull, wall));
    }
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
  const Vec2 centre = all.movers[self.mover].position, ahead = self.state().heading(self.row);
  const int count =
      all.nearest.find(centre, ahead, self.options.neighborDist, most, likely, seen, all.neighbors.data());
  for (int k = 0; k < count; ++k) others.push_back(all.neighbors[k].index);
  likely = others;
}

Encounter meet(const FootprintSelf& self, int m) {
  const World& world = self.world();
  const int theirs = self.all.group[m], other = self.decision.first_row + world.moving[m];
  const bool standing = self.state().stopped[other] != 0;
  const bool mutual =
      theirs >= 0 && (theirs == self.all.member_of[self.mover] || sees_role(world, world.moving[m], self.object));
  const bool alike = mutual && std::holds_alternative<FootprintOrcaOptions>(world.behaviors[theirs].behavior);
  return {m, standing, mutual, alike, standing ? Vec2{} : self.all.movers[m].velocity};
}

/// Meet a mover that the object avoids: a threat, and a border if it is near.
void meet_mover(FootprintSelf& self, int m) {
  const OrcaCrowd& all = self.all;
  FootprintCrowd& crowd = self.crowd;
  const World& world = self.world();
  const Encounter encounter = meet(self, m);
  const double gain = encounter.mutual ? 2.0 : 1.0;
  const bool strange = !encounter.standing && !encounter.alike;
  const double margin = self.options.safe_distance + (strange ? kStrangerDistance : 0.0);
  const double horizon = encounter.standing ? self.options.timeHorizonObst
                                            : self.options.timeHorizon * (strange ? kStrangerHorizons : 1.0);
  Threat threat{{}, gain, self.velocity * (gain - 1.0) + encounter.moves, horizon, encounter.standing};
  const Shapes& shapes = *self.state().scenes[self.decision.w()].shapes;
  const Vec2 offset = all.movers[m].position - all.movers[self.mover].position;
  const double radii = shapes.radius[self.object] + shapes.radius[world.moving[m]] + margin;
  const double gap = norm(offset) - radii, stride = 2.0 * self.stride() + norm(encounter.moves) * world.step_time;
  if (gap > horizon * (gain * self.speed + norm(threat.base))) return bound_by_mover(self, encounter, nullptr);
  // Circles stand for bodies that are far, and for those whose way is not known as long as they do not overlap.
  const bool discs = strange ? gap > 0.0 : gap > std::max(kOutlineDistance, stride);
  if (discs) {
    cone_of(offset, radii, crowd.faces, threat.cone);
    crowd.threats.push_back(threat);
    return bound_by_mover(self, encounter, nullptr);
  }
  const Separation apart = cone_of(self.hull, crowd.hulls[m], margin, m < self.mover, crowd.faces, threat.cone);
  crowd.threats.push_back(threat);
  bound_by_mover(self, encounter, &apart);
}

/// Bound the cell by movers that the object does not avoid because others are nearer, but could touch.
void meet_reachable(FootprintSelf& self, OrcaCrowd& all) {
  const World& world = self.world();
  FootprintCrowd& crowd = self.crowd;
  std::vector<int>& others = crowd.others;
  const double reach = self.limits().range + all.movers[self.mover].radius + crowd.widest + kStrangerDistance;
  const int most = static_cast<int>(all.movers.size()) - 1;
  const bool cut = static_cast<int>(others.size()) == std::min(self.options.maxNeighbors, most);
  const Vec2 centre = all.movers[self.mover].position, ahead = self.state().heading(self.row);
  const double known = cut && !others.empty() ? norm(all.movers[others.back()].position - centre)
                       : cut                  ? 0.0
                                              : self.options.neighborDist;
  if (known >= reach || static_cast<int>(others.size()) == most) return;
  const int group = all.member_of[self.mover];
  if (static_cast<int>(all.neighbors.size()) < most) all.neighbors.resize(most);
  const auto seen = [&](int m) {
    return m != self.mover && (all.member_of[m] == group || sees_role(world, self.object, world.moving[m])) &&
           std::find(others.begin(), others.end(), m) == others.end();
  };
  const int count = all.nearest.find(centre, ahead, reach, most, {}, seen, all.neighbors.data());
  for (int k = 0; k < count; ++k) bound_by_mover(self, meet(self, all.neighbors[k].index), nullptr);
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
    meet_reachable(self, all);
    intents[k] = best_intent(self, wanted_velocity(self));
  }
}

}  // namespace irsim
