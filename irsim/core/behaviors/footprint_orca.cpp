// What an object with footprint_orca does in one step.
#include "behaviors/footprint_orca.hpp"

#include <algorithm>
#include <cstdlib>

#include "orca/crowd.hpp"
#include "orca/footprint_crowd.hpp"
#include "orca/obstacles.hpp"
#include "random.hpp"
#include "surroundings/sidestep.hpp"
#include "world/features.hpp"

namespace irsim {
namespace {

double tune(const char* name, double value) {
  const char* text = std::getenv(name);
  return text ? std::atof(text) : value;
}

constexpr double kLeastGap = 0.005;  // part of a gap that nobody uses [m]
constexpr double kPush = 0.3;        // largest speed at which bodies leave each other's margins [m/s]

bool cannot_slide(const Drive& drive) {
  return !std::holds_alternative<OmniOptions>(drive) && !std::holds_alternative<OmniAngularOptions>(drive);
}

bool sees(const World& world, int viewer, int other) {
  const int wanted = world.target_roles[viewer];
  return wanted == 0 || (wanted == 1) == (world.is_robot[other] != 0);
}

/// One object in one step.
struct Self {
  const FootprintOrcaOptions& options;
  const Decision& decision;
  OrcaCrowd& all;
  FootprintCrowd& outlines;
  int object, row, mover;
  Hull hull;
  Vec2 position, velocity, heading;
  double speed;      // largest [m/s]
  bool stalled = false;
  double fast_turn;  // speed at which a turn moves the outermost point [m/s]
};

double top(const FootprintOrcaOptions& options, const World& world, const State& state, int row, int object) {
  const Vec3& most = state.vel_max[row];
  const double own = cannot_slide(world.drive[object]) ? most[0] : std::min(most[0], most[1]);
  return std::max(0.0, options.maxSpeed ? std::min(*options.maxSpeed * state.pace[row], own) : own);
}

/// Half the width of the lane that a body needs to move [m].
double half_width(const Self& self) {
  const bool slides = !cannot_slide(self.decision.world.drive[self.object]);
  const Vec2 left{-self.heading.y, self.heading.x};
  double most = 0.0;
  for (int k = 0; k < self.hull.count; ++k) {
    const Vec2 corner = self.hull.corner[k] - self.position;
    most = std::max(most, slides ? norm(corner) : std::fabs(dot(left, corner)));
  }
  return most + self.hull.round;
}

Vec2 way_point(Self& self, Vec2 goal, Detour& detour, std::int64_t now) {
  static const double lane = tune("FO_LANE", 0.02);
  static const int again = static_cast<int>(tune("FO_AGAIN", 30));
  const std::vector<Blocker>& blockers = self.outlines.blockers;
  const Decision& decision = self.decision;
  if (blockers.empty()) return goal;
  const double radius = half_width(self) + lane;
  const Vec2 way = goal - self.position;
  const double distance = norm(way), reach = std::max(0.0, decision.world.goal_threshold[self.object] - 0.02);
  const Vec2 end = distance > reach ? goal - way * (reach / distance) : self.position;
  if (is_open(self.position, end, radius, blockers)) {
    detour.points.clear(), detour.planned = -1;
    return goal;
  }
  const int standing = static_cast<int>(blockers.size());
  bool search = detour.planned < 0 || now >= detour.planned + again;
  if (!search && detour.standing != standing && !detour.points.empty()) {
    Vec2 from = self.position;
    for (std::size_t k = detour.next; k < detour.points.size() && !search; ++k) {
      search = !is_open(from, detour.points[k], radius, blockers);
      from = detour.points[k];
    }
    detour.standing = standing;
  }
  if (search) {
    find_detour(self.position, goal, reach, radius, blockers, self.outlines.search, detour.points);
    detour.planned = now, detour.standing = standing, detour.next = 0;
  }
  if (detour.points.empty()) return goal;
  while (detour.next + 1 < detour.points.size() &&
         (squared(detour.points[detour.next] - self.position) < 0.01 ||
          is_open(self.position, detour.points[detour.next + 1], radius, blockers)))
    ++detour.next;
  return detour.points[detour.next];
}

/// The point to head for: the goal, or the next corner of a way round what stands.
Vec2 aim(Self& self, Vec2 goal) {
  const Decision& decision = self.decision;
  const State& state = decision.state;
  Detour& detour = decision.detours[self.row];
  const std::int64_t now = state.count[decision.w()];
  if (squared(detour.goal - goal) > 0.0) detour.points.clear(), detour.planned = -1, detour.goal = goal;
  detour.step = now;
  std::vector<Blocker>& blockers = self.outlines.blockers;
  const std::size_t standing_now = blockers.size();
  if (self.stalled) {
    for (const int m : self.all.neighbors_before[self.mover]) {
      const int row = decision.first_row + decision.world.moving[m];
      if (state.stopped[row] || state.arrived[row] || squared(self.all.movers[m].velocity) > 0.01) continue;
      blockers.push_back({self.outlines.hulls[m], self.all.movers[m].position, self.all.movers[m].radius});
    }
  }
  const Vec2 point = way_point(self, goal, detour, now);
  blockers.resize(standing_now);
  return point;
}
Vec2 wanted_velocity(Self& self) {
  const State& state = self.decision.state;
  const World& world = self.decision.world;
  const Goal& goal = state.destination(self.row);
  if (std::isnan(goal.x)) return {};
  const double left = norm(goal.position() - self.position);
  static const double yield_gap = tune("FO_YIELD", 0.3);
  if (state.arrived[self.row] && yield_gap > 0.0) {
    Vec2 push;
    for (const int m : self.all.neighbors_before[self.mover]) {
      const int other = self.decision.first_row + world.moving[m];
      if (state.arrived[other] || state.stopped[other]) continue;
      const Separation apart = separation(self.hull, self.outlines.hulls[m]);
      if (apart.gap < yield_gap) push = push + apart.axis * (1.0 - apart.gap / yield_gap);
    }
    if (squared(push) > 0.0) return push * (self.speed / std::max(1.0, norm(push)));
  }
  if (!(left > 0.0 && left >= world.goal_threshold[self.object])) return {};
  static const int patience = static_cast<int>(tune("FO_PATIENCE", 12)), period = static_cast<int>(tune("FO_PERIOD", 10));
  static const double progress = tune("FO_PROGRESS", 0.3), least_turn = tune("FO_LEAST", 60) * kPi / 180, most_turn = tune("FO_MOST", 180) * kPi / 180;
  Detour& detour = self.decision.detours[self.row];
  const std::int64_t now = state.count[self.decision.w()];
  if (detour.step != now - 1 && detour.step != now) detour = {};
  if (detour.anchored < 0 || squared(detour.anchor - self.position) > progress * progress)
    detour.anchor = self.position, detour.anchored = now;
  const std::int64_t stalled = now - detour.anchored - patience;
  self.stalled = stalled >= 0;
  const Vec2 way = aim(self, goal.position()) - self.position;
  const double distance = norm(way);
  if (!(distance > 0.0)) return {};
  const Vec2 wanted = way * (std::min(self.speed, left / world.step_time) / distance);
  if (stalled < 0 || (stalled / period) % 2 == 1) return wanted;
  const Draws draws(state.key(self.decision.w()), Stream::behavior, world.number[self.object]);
  const auto u = draws.uniforms(static_cast<std::uint64_t>(detour.anchored + patience + stalled / period * period));
  return rotate(wanted, unit((u[0] < 0.5 ? -1.0 : 1.0) * (least_turn + u[1] * (most_turn - least_turn))));
}

void add_threat(Self& self, Hull other, bool mine_first, Vec2 moves, double share, bool standing, Separation& apart) {
  std::vector<Face>& faces = self.outlines.faces;
  Threat threat;
  const double margin = self.options.safe_distance;
  (void)mine_first;
  apart = cone_of(self.hull, other, margin, faces, threat.cone);
  threat.gain = 1.0 / share;
  threat.base = self.velocity * (threat.gain - 1.0) + moves;
  threat.standing = standing;
  self.outlines.threats.push_back(threat);
}

void meet_static(Self& self, double horizon) {
  const Decision& decision = self.decision;
  const Obstacles& obstacles = decision.state.scenes[decision.w()].fixed->obstacles;
  if (obstacles.empty()) return;
  const World& world = decision.world;
  const double radius = self.all.movers[self.mover].radius;
  const double reach = std::max(horizon, 2.0 * world.step_time) * (self.speed + self.fast_turn) + radius;
  Hulls& scratch = self.outlines.walls;
  scratch.clear();
  const int edges = static_cast<int>(obstacles.edges.size());
  self.all.edges.clear();
  const Vec2 centre = self.all.movers[self.mover].position;
  obstacles.near(box_around(centre, reach), [&](int k) {
    if (k < edges) {
      const Edge& edge = obstacles.edges[k];
      if (!edge.faces(centre) || (edge.object >= 0 && !sees(world, self.object, edge.object))) return;
      const Vec2 nearest = nearest_on_segment(edge.left.point, edge.right.point, centre);
      if (norm(nearest - centre) < reach) self.all.edges.push_back({squared(nearest - centre), k});
    } else {
      const StaticDisc& disc = obstacles.discs[k - edges];
      const double gap = norm(disc.centre - centre) - disc.radius;
      if (gap < reach && sees(world, self.object, disc.object)) self.all.edges.push_back({gap * gap, k});
    }
  });
  std::sort(self.all.edges.begin(), self.all.edges.end());
  for (const Nearest::Found& found : self.all.edges) {
    if (found.index < edges) {
      const Edge& edge = obstacles.edges[found.index];
      scratch.add(edge.left.point, edge.right.point);
    } else {
      const StaticDisc& disc = obstacles.discs[found.index - edges];
      scratch.add(disc.centre, disc.radius);
    }
    Separation apart;
    const Hull wall = scratch[scratch.count() - 1];
    add_threat(self, wall, true, {}, 1.0, true, apart);
    if (apart.gap < 2.0 * world.step_time * (self.speed + self.fast_turn))
      self.outlines.borders.push_back(border(self.hull, apart, kLeastGap));
  }
}

void meet_mover(Self& self, int m, bool standing) {
  static const double share_of_mutual = tune("FO_SHARE", 0.5);
  const Decision& decision = self.decision;
  const World& world = decision.world;
  OrcaCrowd& all = self.all;
  const Hull other = self.outlines.hulls[m];
  const int theirs = all.group[m];
  const bool mutual = theirs >= 0 && (theirs == all.member_of[self.mover] || sees(world, world.moving[m], self.object));
  const bool alike = mutual && std::holds_alternative<FootprintOrcaOptions>(world.behaviors[theirs].behavior);
  const Vec2 moves = standing ? Vec2{} : all.movers[m].velocity;
  Separation apart;
  add_threat(self, other, self.mover < m, moves, mutual ? share_of_mutual : 1.0, standing, apart);
  const double reach = 2.0 * world.step_time * (self.speed + self.fast_turn + norm(moves));
  if (apart.gap > reach) return;
  if (self.mover < m) {
    apart = separation(self.hull, other);
  } else {
    apart = separation(other, self.hull);
    apart.axis = apart.axis * -1.0;
  }
  if (standing) {
    self.outlines.fixed.push_back({other, std::min(kLeastGap, apart.gap)});
  } else if (alike) {
    const double own = std::max(0.0, -dot(apart.axis, self.velocity));
    const double others = std::max(0.0, dot(apart.axis, moves));
    self.outlines.borders.push_back(border(self.hull, apart, own, others, kLeastGap));
  } else {
    const double shift = std::max(0.0, dot(apart.axis, moves) * world.step_time);
    self.outlines.borders.push_back(border(self.hull, {apart.axis, apart.gap - shift}, kLeastGap));
  }
}

void meet_movers(Self& self) {
  const Decision& decision = self.decision;
  for (const int m : self.all.neighbors_before[self.mover]) {
    meet_mover(self, m, decision.state.stopped[decision.first_row + decision.world.moving[m]] != 0);
  }
}

void find_movers(Self& self) {
  OrcaCrowd& all = self.all;
  const World& world = self.decision.world;
  std::vector<int>& before = all.neighbors_before[self.mover];
  const int most = std::min(self.options.maxNeighbors, static_cast<int>(all.movers.size()) - 1);
  const int group = all.member_of[self.mover];
  if (most <= 0) return before.clear();
  if (static_cast<int>(all.neighbors.size()) < most) all.neighbors.resize(most);
  const auto seen = [&](int m) {
    return m != self.mover && (all.member_of[m] == group || sees(world, self.object, world.moving[m]));
  };
  const int count = all.nearest.find(all.movers[self.mover].position, self.options.neighborDist, most, before, seen,
                                     all.neighbors.data());
  before.clear();
  for (int k = 0; k < count; ++k) before.push_back(all.neighbors[k].index);
}

/// The control that the limits of an object leave of a wanted one.
Vec3 limited(const Self& self, Vec3 wanted) {
  const World& world = self.decision.world;
  const State& state = self.decision.state;
  const Vec3& now = state.control[self.row];
  Vec3 next;
  for (int c = 0; c < 3; ++c) {
    const double change = state.acce[self.row][c] * world.step_time;
    next[c] = clip(wanted[c], std::max(state.vel_min[self.row][c], now[c] - change),
                   std::min(state.vel_max[self.row][c], now[c] + change));
  }
  with(world.drive[self.object], [&](const auto& drive) { next = constrain(drive, next); });
  return next;
}

/// The pose after one step with a control.
Pose after(const Self& self, Vec3 control, std::vector<double>& extra) {
  const World& world = self.decision.world;
  const State& state = self.decision.state;
  Pose pose = state.pose[self.row];
  Vec3 twist;
  const double* now = &state.extra[static_cast<std::size_t>(self.row) * state.extra_rows];
  extra.assign(now, now + state.extra_rows);
  with(world.drive[self.object], [&](const auto& drive) {
    run(drive, Motion{pose, extra.data(), twist, self.heading, control, world.step_time});
  });
  return pose;
}

struct Tried {
  Vec3 control;
  Pose pose;
  double room;
};

Tried attempt(Self& self, Vec3 control) {
  Tried tried{control, {}, kInfinity};
  tried.pose = after(self, limited(self, control), self.outlines.extra);
  const Vec2 turn = unit(tried.pose.theta - self.decision.state.pose[self.row].theta);
  const Vec2 shift = tried.pose.position() - self.position;
  tried.room = room(self.hull, self.position, shift, turn, self.outlines.borders);
  if (tried.room < 0.0 || self.outlines.fixed.empty()) return tried;
  std::vector<Vec2>& moved = self.outlines.moved;
  moved.resize(2 * static_cast<std::size_t>(self.hull.count));
  for (int k = 0; k < self.hull.count; ++k) {
    moved[k] = self.position + shift + rotate(self.hull.corner[k] - self.position, turn);
    moved[self.hull.count + k] = rotate(self.hull.normal[k], turn);
  }
  const Hull body{moved.data(), moved.data() + self.hull.count, self.hull.count, self.hull.round};
  for (const Fixture& one : self.outlines.fixed)
    tried.room = std::min(tried.room, separation(body, one.hull).gap - one.gap);
  return tried;
}

/// Forward speed and turn rate toward a velocity.
Vec3 drive_toward(const Self& self, Vec2 velocity) {
  const State& state = self.decision.state;
  const double speed = norm(velocity), dt = self.decision.world.step_time;
  if (speed < 1e-6) return {};
  double error = std::atan2(cross(self.heading, velocity), dot(self.heading, velocity));
  double sign = 1.0;
  const double back = -state.vel_min[self.row][0];
  if (self.options.backward && back > 0.0) {
    const double limit = 0.5 * kPi + (state.control[self.row][0] < 0.0 ? -0.3 : 0.3);
    if (std::fabs(error) > limit) sign = -1.0, error = wrap(error + kPi);
  }
  const double most = state.vel_max[self.row][1];
  return {{sign * speed * std::max(0.0, std::cos(error)), clip(error / dt, -most, most), 0.0}};
}

Vec3 control_for_velocity(const Self& self, Vec2 velocity) {
  if (cannot_slide(self.decision.world.drive[self.object])) return drive_toward(self, velocity);
  const Vec2 body = unrotate(velocity, self.heading);
  return {{body.x, body.y, 0.0}};
}

Vec3 best_control(Self& self, Vec2 preferred) {
  static const double danger = tune("FO_DANGER", 0.5), danger_still = tune("FO_STILL", 0.2), turning = tune("FO_TURN", 0.1),
                      side = tune("FO_SIDE", 0.02), soft = tune("FO_SOFT", 0.1);
  const bool slides = !cannot_slide(self.decision.world.drive[self.object]);
  const bool reverses = self.options.backward && self.decision.state.vel_min[self.row][0] < 0.0;
  const double wanted = norm(preferred);
  const Vec2 ahead = wanted > 0.0 ? preferred * (1.0 / wanted) : self.heading;
  std::vector<Option>& tries = self.outlines.tries;
  tries.clear();
  const auto consider = [&](Vec2 v) {
    static const double lazy = tune("FO_LAZY", 0.3);
    const double speed = norm(v);
    double cost = wanted > 0.0 ? 1.0 - dot(v, ahead) / self.speed + lazy * (1.0 - speed / self.speed) : speed;
    double worst = 0.0, worst_still = 0.0;
    for (const Threat& threat : self.outlines.threats) {
      const double time = threat.cone.time(v * threat.gain - threat.base, self.outlines.faces.data());
      const double horizon = threat.standing ? self.options.timeHorizonObst : self.options.timeHorizon;
      if (time >= horizon) continue;
      double& most = threat.standing ? worst_still : worst;
      most = std::max(most, 1.0 / (time + soft) - 1.0 / (horizon + soft));
    }
    cost += danger * worst + danger_still * worst_still;
    if (!slides && speed > 1e-6) {
      double error = std::acos(clip(dot(v, self.heading) / speed, -1.0, 1.0));
      if (reverses) error = std::min(error, kPi - error);
      cost += turning * error;
    }
    cost += side * std::max(0.0, cross(ahead, v));
    tries.push_back({cost, v});
  };
  consider(preferred);
  consider({});
  constexpr int kDirections = 16;
  for (int k = 0; k < kDirections; ++k) {
    const Vec2 way = rotate(ahead, unit(kTurn * k / kDirections));
    for (const double share : {1.0, 0.6, 0.25}) {
      if (k == 0 && share == 1.0 && wanted >= self.speed) continue;
      consider(way * (share * self.speed));
    }
  }
  if (!slides) {
    for (const double share : {1.0, 0.5, 0.15}) {
      consider(self.heading * (share * self.speed));
      if (reverses) consider(self.heading * (-share * self.speed));
    }
  }
  Tried best = attempt(self, {});
  for (std::size_t tried = 0; tried < tries.size(); ++tried) {
    std::size_t least = tried;
    for (std::size_t k = tried + 1; k < tries.size(); ++k)
      if (tries[k].cost < tries[least].cost) least = k;
    std::swap(tries[tried], tries[least]);
    const Tried found = attempt(self, control_for_velocity(self, tries[tried].velocity));
    if (found.room >= 0.0) return found.control;
    if (found.room > best.room) best = found;
  }
  return best.control;
}

}  // namespace

void footprint_orca(const FootprintOrcaOptions& options, const Decision& decision, Intent* intents) {
  const World& world = decision.world;
  const State& state = decision.state;
  const Scene& scene = state.scenes[decision.w()];
  OrcaCrowd& all = crowd(world, state, decision.work, decision.w());
  if (!all.outlines) all.outlines = std::make_shared<FootprintCrowd>();
  FootprintCrowd& outlines = *all.outlines;
  if (!outlines.known) {
    outlines.known = true;
    outlines.hulls.clear();
    for (const int i : world.moving) {
      const int row = decision.first_row + i;
      outlines.hulls.add(*scene.shapes, i, state.pose[row].position(), state.heading(row));
    }
    outlines.blockers.clear();
    for (const int i : world.moving) {
      const int mover = scene.shapes->placed[i].object;
      const int other = decision.first_row + i;
      const bool rests = state.arrived[other] && squared(all.movers[mover].velocity) < 0.01;
      if (!state.stopped[other] && !rests) continue;
      outlines.blockers.push_back({outlines.hulls[mover], all.movers[mover].position, scene.shapes->radius[i]});
    }
  }
  for (int k = 0; k < decision.count; ++k) {
    const int i = decision.objects[k], row = decision.row(k), mover = scene.shapes->placed[i].object;
    Self self{options, decision, all,  outlines, i, row, mover, outlines.hulls[mover], state.pose[row].position(),
              all.movers[mover].velocity, state.heading(row), 0.0, false, 0.0};
    self.speed = top(options, world, state, row, i);
    const double reach = norm(scene.shapes->centre[i]) + scene.shapes->radius[i];
    if (std::holds_alternative<DiffOptions>(world.drive[i])) self.fast_turn = state.vel_max[row][1] * reach;
    outlines.borders.clear();
    outlines.threats.clear(), outlines.faces.clear(), outlines.fixed.clear();
    find_movers(self);
    meet_static(self, options.timeHorizonObst);
    meet_movers(self);
    intents[k] = Intent::of_control(best_control(self, wanted_velocity(self)));
  }
}

}  // namespace irsim
