// Half-planes of everything that an object avoids, and the best velocity within them.
#include "orca/avoidance.hpp"

#include <algorithm>

#include "geometry/predicates.hpp"
#include "orca/body_discs.hpp"
#include "orca/crowd.hpp"
#include "orca/obstacles.hpp"
#include "orca/standing.hpp"
#include "routes/right_of_way.hpp"
#include "surroundings/passing.hpp"
#include "surroundings/sidestep.hpp"
#include "surroundings/ties.hpp"
#include "world/features.hpp"
#include "world/spec.hpp"

namespace irsim {
namespace {

constexpr double kMinSpeed = 1e-6;           // slower velocities are rounding errors [m/s]
constexpr double kRouteHorizon = 0.5;        // time horizon for walls on a route, which already avoids them [s]
constexpr double kMaxCarAngle = 1.2;         // largest angle between the heading and the velocity of a car [rad]
constexpr double kStuckShare = 0.1;          // a car below this share of its wanted speed backs up
constexpr double kBackingShare = 0.3;        // share of its speed at which a car wants to back up
constexpr double kMaxBackingSteering = 0.5;  // largest steering angle of a car that backs up [rad]
constexpr double kMinCarShare = 0.2;     // smallest share of a wanted speed, because a car turns only while it rolls
constexpr double kMostFrontAngle = 1.0;  // largest angle of a driven wheel for smaller heading errors [rad]
constexpr double kMinFrontShare = 0.4;   // smallest share of its speed that a driven wheel counts as taking ahead
constexpr double kLeanSpeed = 1e-7;      // velocities of a mirrored pair differ by less [m/s]
constexpr double kLeanShare = 0.2;       // what one of a mirrored pair takes over from the share of the other
constexpr double kLeanTurn = 15.0;       // turn of the wanted velocity where a pair is on one line [degrees]

/// Largest speed [m/s] in every direction, or forward for drives that cannot move sideways.
double top_speed(const OrcaSettings& options, const World& world, const State& state, int row, int object) {
  const Vec3& top = state.vel_max[row];
  const Drive& drive = world.drive[object];
  const bool sideways = std::holds_alternative<OmniOptions>(drive) || std::holds_alternative<OmniAngularOptions>(drive);
  const double own = sideways ? std::min(top[0], top[1]) : top[0];
  return std::max(0.0, options.maxSpeed ? std::min(*options.maxSpeed * state.pace[row], own) : own);
}

/// Toward the goal, at full speed or as `approach_time` says; zero without a goal or within `goal_threshold` of it. As
/// in IR-SIM, an `omni` drive with unequal limits leans toward the axis of the world with the larger limit.
///
/// Args:
///   way: To the goal, `distance` [m] away; not a number without one.
Vec2 preferred_velocity(const OrcaSettings& options, const World& world, const State& state, int row, int object,
                        double speed, Vec2 way, double distance) {
  if (!(distance > 0.0 && distance >= world.goal_threshold[object])) return {};
  if (options.approach_time) speed = std::min(speed, distance / *options.approach_time);
  const Vec3& top = state.vel_max[row];
  if (top[0] == top[1] || !std::holds_alternative<OmniOptions>(world.drive[object])) return way * (speed / distance);
  way = {way.x * top[0], way.y * top[1]};
  const double length = norm(way);
  return length > 0.0 ? way * (speed / length) : Vec2{};
}

/// How a drive that cannot move sideways turns. As in IR-SIM, small changes of direction and slow velocities are
/// ignored. They count for an object that avoids another one, because the next step would ask for the same change
/// again.
Turning turning_for(const World& world, const State& state, int row, bool avoiding) {
  Turning turning;
  turning.guarantee_time = world.step_time;
  turning.max_rate = state.vel_max[row][1];
  if (avoiding) turning.min_speed = kMinSpeed, turning.tolerance = 0.0;
  return turning;
}

/// Restrict the velocities of a car, which turns only while it rolls, to a sector about its heading, and turn
/// `preferred` into it. `planes` must be empty; both planes added include zero.
void face_ahead(Vec2 heading, std::vector<HalfPlane>& planes, Vec2& preferred) {
  const Vec2 most = unit(kMaxCarAngle), left = rotate(heading, most), right = rotate(heading, {most.x, -most.y});
  planes.push_back({{}, right});
  planes.push_back({{}, left * -1.0});
  const bool ahead = planes[0].depth(preferred) >= 0.0 && planes[1].depth(preferred) >= 0.0;
  if (!ahead) preferred = (cross(heading, preferred) > 0.0 ? left : right) * norm(preferred);
}

/// Controls with which a car realises `velocity`. At the end of the next period the heading is right, if the angle acts
/// in that one and in a share of this one.
Vec3 car_control(const Car& car, const World& world, const State& state, int row, Vec2 velocity, double most) {
  const double speed = norm(velocity), dt = world.step_time, psi = state.extra[std::size_t(row) * state.extra_rows];
  const double wheelbase = car.wheelbase > 0.0 ? car.wheelbase : 1.0;
  Vec3 control;
  double target = psi;
  if (speed > kMinSpeed) {
    const Vec2 heading = state.heading(row);
    control[0] = std::min(std::max(dot(heading, velocity), kMinCarShare * speed), most);
    if (car.front) control[0] /= std::max(std::cos(psi), kMinFrontShare);
    const double rolling = std::max(control[0], kMinCarShare * kMinCarShare);
    const double error = std::atan2(cross(heading, velocity), dot(heading, velocity));
    const double now = car.yaw(psi) * control[0] / rolling;
    target = car.angle_for((error * wheelbase / (rolling * dt) - (1.0 - car.acts) * now) / (1.0 + car.acts));
    if (car.front) {  // a wheel that stands across takes the body nowhere
      const double across = std::max(std::fabs(error), kMostFrontAngle);
      target = clip(target, -across, across);
    }
  }
  const double range = steering_range(car);
  control[1] = car.mode == Steering::steer ? target : (clip(target, -range, range) - psi) / dt;
  return control;
}

/// Largest speed along `direction` within planes that include zero [m/s].
double fastest_along(Vec2 direction, const HalfPlane* planes, int count) {
  double most = kInfinity;
  for (int k = 0; k < count; ++k) {
    const double rate = cross(planes[k].direction, direction);
    if (rate < -kParallelSine) most = std::min(most, std::max(0.0, -planes[k].depth({}) / rate));
  }
  return most;
}

/// Find controls with which a blocked car backs up as fast as the obstacles behind it allow, turning toward
/// `preferred`. Returns false if that is not faster than `ahead` [m/s]. The first two planes come from `face_ahead`,
/// which are reversed.
bool back_off(const Car& car, const World& world, const State& state, int row, double speed, int hard, double ahead,
              Vec2 preferred, OrcaCrowd& all, Vec3& control) {
  const Vec2 heading = state.heading(row), behind = heading * -1.0;
  for (int k = 0; k < 2; ++k) all.planes[k].direction = all.planes[k].direction * -1.0;
  Vec2 found;
  choose_velocity(all.planes.data(), static_cast<int>(all.planes.size()), hard, speed, behind * (kBackingShare * speed),
                  all.scratch, found);
  const double back = std::min(dot(found, behind), fastest_along(behind, all.planes.data(), hard));
  if (back <= ahead) return false;
  const double psi = state.extra[static_cast<std::size_t>(row) * state.extra_rows];
  const double target =
      -clip(std::atan2(cross(heading, preferred), dot(heading, preferred)), -kMaxBackingSteering, kMaxBackingSteering);
  control = {{-back, car.mode == Steering::steer ? target : (target - psi) / world.step_time, 0.0}};
  return true;
}

/// Add half-planes of walls and static circles, nearest edges first, of equally near ones those on the right of
/// `ahead`. Planes that others cover are left out.
void avoid_obstacles(double horizon, const World& world, const Fixed& fixed, const OrcaAgent& agent, int object,
                     double speed, Vec2 ahead, OrcaCrowd& all) {
  const Obstacles& obstacles = fixed.obstacles;
  if (obstacles.empty()) return;
  Sight sight(fixed.walls, agent.position);
  const double reach = horizon * speed + agent.radius;
  const int edges = static_cast<int>(obstacles.edges.size());
  std::vector<HalfPlane>& planes = all.planes;
  all.edges.clear();
  all.neighbors.clear();  // holds the discs found
  obstacles.near(box_around(agent.position, reach), [&](int k) {
    if (k >= edges) {
      const StaticDisc& disc = obstacles.discs[k - edges];
      const double gap = norm(disc.centre - agent.position) - disc.radius;
      if (gap < reach && targets_role(world, object, disc.object)) all.neighbors.push_back({gap, k - edges});
      return;
    }
    const Edge& edge = obstacles.edges[k];
    if (!sight.sees(edge) || (edge.object >= 0 && !targets_role(world, object, edge.object))) return;
    const Vec2 nearest = nearest_on_segment(edge.left.point, edge.right.point, agent.position);
    const double distance2 = squared(nearest - agent.position);
    // Of two edges whose nearest point is their common corner, the one that ends there comes first.
    const int rank = dot(agent.position - edge.left.point, edge.direction()) <= 0.0 ? k + edges : k;
    if (distance2 < reach * reach) all.edges.push_back({distance2, rank});
  });
  const auto covered = [&](Vec2 a, Vec2 b, double radius) {
    return std::any_of(planes.begin(), planes.end(),
                       [&](const HalfPlane& plane) { return covers(plane, agent, a, b, radius, horizon); });
  };
  std::sort(all.edges.begin(), all.edges.end(), [&](const Nearest::Found& a, const Nearest::Found& b) {
    if (a.distance2 != b.distance2) return a.distance2 < b.distance2;
    if ((a.index < edges) != (b.index < edges)) return a.index < b.index;
    const Edge &one = obstacles.edges[a.index % edges], &two = obstacles.edges[b.index % edges];
    return is_right_of(one.left.point, two.left.point, ahead, a.index < b.index);
  });
  for (const Nearest::Found& found : all.edges) {
    const Edge& edge = obstacles.edges[found.index % edges];
    HalfPlane plane;
    if (covered(edge.left.point, edge.right.point, agent.radius)) continue;
    if (avoid_edge(agent, edge, horizon, plane)) planes.push_back(plane);
  }
  std::sort(all.neighbors.begin(), all.neighbors.end(), [&](const Nearest::Found& a, const Nearest::Found& b) {
    if (a.distance2 != b.distance2) return a.distance2 < b.distance2;
    return is_right_of(obstacles.discs[a.index].centre, obstacles.discs[b.index].centre, ahead, a.index < b.index);
  });
  for (const Nearest::Found& found : all.neighbors) {
    const StaticDisc& disc = obstacles.discs[found.index];
    if (covered(disc.centre, disc.centre, agent.radius + disc.radius)) continue;
    planes.push_back(avoid_disc(agent, disc.centre, disc.radius, horizon));
  }
}

/// Add half-planes of two movers, at least one of which is long, from the discs that cover them. On a route this closes
/// no passage that is wide enough for both. Returns false if both are their bounding circles.
///
/// Args:
///   agent, seen: The bounding circles of `self` and of `other`, with their margins, as `self` takes them.
bool avoid_discs(const World& world, const State& state, int w, int self, int other, const OrcaAgent& agent,
                 const OrcaAgent& seen, double share, double horizon, std::vector<HalfPlane>& planes) {
  const Shapes& shapes = *state.scenes[w].shapes;
  const int movers[] = {self, other};
  const OrcaAgent* circles[] = {&agent, &seen};
  BodyDiscs discs[2];
  for (int side = 0; side < 2; ++side) discs[side] = body_discs(shapes, world.moving[movers[side]]);
  if (discs[0].count == 1 && discs[1].count == 1) return false;
  const auto disc = [&](int side, int k) {
    const int object = world.moving[movers[side]], row = w * world.objects + object;
    const double margin = circles[side]->radius - shapes.radius[object];
    const Vec2 centre = state.pose[row].position() + rotate(discs[side].centres[k], state.heading(row));
    return OrcaAgent{centre, circles[side]->velocity, discs[side].radius + margin};
  };
  for (int k = 0; k < discs[0].count; ++k) {
    for (int n = 0; n < discs[1].count; ++n) {
      avoid_agent(disc(0, k), disc(1, n), share, horizon, world.step_time, self < other, planes.emplace_back());
    }
  }
  return true;
}

/// Whether objects with these settings break ties: the share that one of a pair takes over is left to it by the other.
bool breaks_ties(const OrcaSettings& options) { return !options.sidestep && !options.responsibility; }
bool breaks_ties(const Behavior& behavior) {
  if (const auto* orca = std::get_if<OrcaOptions>(&behavior)) return breaks_ties(*orca);
  const auto* avocado = std::get_if<AvocadoOptions>(&behavior);
  return avocado != nullptr && breaks_ties(*avocado);
}

/// Largest difference of the squared speeds of a mirrored pair, one of which is `speed2` [m^2/s^2]. Both velocities
/// differ by at most 2 kLeanSpeed times the sum of both speeds, and no speed exceeds 1 + speed2.
double same_speed2(double speed2) { return 4.0 * kLeanSpeed * (2.0 + speed2); }

/// Ties of an object with its neighbors.
struct Ties {
  bool any = false;      // whether it is one of a mirrored pair
  bool on_line = false;  // whether it meets the other one of a pair head-on
};

/// The share that an object takes over from another one of `all` if their motion is mirrored: some of that for one on
/// its right, less than nothing for one on its left. `ties` notes a tie with the other one, within `reach`.
double lean(const World& world, const State& state, int w, const OrcaCrowd& all, int self, int m, double speed,
            double reach, Ties& ties) {
  const OrcaAgent &agent = all.movers[self], &other = all.movers[m];
  if (!may_mirror(other.position - agent.position, agent.velocity + other.velocity, reach, kLeanSpeed)) return 0.0;
  if (!breaks_ties(world.behaviors[all.group[m]].behavior)) return 0.0;
  const int first = w * world.objects;
  const std::optional<double> side =
      mirrored(state, {first + world.moving[self], first + world.moving[m], agent.velocity, other.velocity, speed,
                       agent.radius + other.radius, kLeanSpeed, kTieDirection});
  if (!side) return 0.0;
  ties.any = true;
  if (std::fabs(*side) > kParallelSine) return *side < 0.0 ? kLeanShare : -kLeanShare;
  ties.on_line = true;
  return 0.0;
}

/// Add half-planes of the nearest movers, from the right to the left of `ahead` if they are equally near. Returns
/// the ties with them.
Ties avoid_movers(const OrcaSettings& options, const World& world, const State& state, int w, int self, double speed,
                  Vec2 ahead, const TieWay& way, Reciprocity* reciprocity, OrcaCrowd& all) {
  const int object = world.moving[self], group = all.member_of[self];
  const OrcaAgent& agent = all.movers[self];
  const int most = std::min(options.maxNeighbors, static_cast<int>(all.movers.size()) - 1);
  if (most <= 0) return {};
  if (static_cast<int>(all.neighbors.size()) < most) all.neighbors.resize(most);
  const auto seen = [&](int m) {
    return m != self && (all.member_of[m] == group || targets_role(world, object, world.moving[m]));
  };
  std::vector<int>& before = all.neighbors_before[self];
  const int count =
      all.nearest.find(agent.position, ahead, options.neighborDist, most, before, seen, all.neighbors.data());
  before.resize(count);
  const Nearest::Found *near = all.neighbors.data(), *const end = near + count;
  for (int* note = before.data(); near != end; ++near) *note++ = near->index;
  const int own_row = w * world.objects + object;
  // Few neighbors are ahead at the same speed, which is asked in as few instructions as possible.
  const double speed2 = all.speed2[self], same = same_speed2(speed2);
  const int* groups = all.group.data();
  const bool routes = !state.routes.empty(), routed = state.route_of(own_row) != nullptr;
  Ties ties;
  for (near = all.neighbors.data(); near != end; ++near) {
    const int m = near->index;
    // An object with a given command, one that is stopped or waits to start, or one that does not see this object does
    // not give way.
    const bool mutual = groups[m] >= 0 && (groups[m] == group || targets_role(world, world.moving[m], object));
    double share = options.responsibility ? *options.responsibility : mutual ? 0.5 : 1.0;
    const OrcaAgent* other = &all.movers[m];
    OrcaAgent taken;
    if (reciprocity != nullptr) {
      taken = *other;
      share = reciprocity->share(m, taken);
      other = &taken;
    }
    if (way.may_meet(all.movers[m].position, near->distance2) && std::fabs(all.speed2[m] - speed2) <= same && mutual)
      share = clip(share + lean(world, state, w, all, self, m, speed, options.neighborDist, ties), 0.0, 1.0);
    if (mutual && routes) {
      const Precedence order = precedence(world, state, w, object, world.moving[m]);
      if (order == Precedence::first) continue;
      if (order == Precedence::second) share = 1.0;
    }
    if (share == 0.0) continue;
    if (routed && avoid_discs(world, state, w, self, m, agent, *other, share, options.timeHorizon, all.planes))
      continue;
    avoid_agent(agent, *other, share, options.timeHorizon, world.step_time, self < m, all.planes.emplace_back());
  }
  return ties;
}

}  // namespace

void avoid(const OrcaSettings& options, const Decision& decision, Reciprocity* reciprocity, Intent* intents) {
  const World& world = decision.world;
  const State& state = decision.state;
  const Scene& scene = state.scenes[decision.w()];
  const Fixed& fixed = *scene.fixed;
  OrcaCrowd& all = crowd(world, state, decision.work, decision.w());
  const bool breaks = breaks_ties(options);
  for (int k = 0; k < decision.count; ++k) {
    const int i = decision.objects[k], row = decision.row(k), self = scene.shapes->placed[i].object;
    const OrcaAgent& agent = all.movers[self];
    const double speed = top_speed(options, world, state, row, i);
    all.planes.clear();
    const Vec2 way = state.destination(row).position() - state.pose[row].position();
    const double far = norm(way);
    const Vec2 ahead = far > 0.0 ? way : state.heading(row);
    const Vec2 straight = preferred_velocity(options, world, state, row, i, speed, way, far);
    const Vec2 past = past_walls(decision, k, agent.position, agent.radius, kWallLook, straight, false);
    Vec2 preferred = sidestepped(decision, k, past, options.sidestep.value_or(0.0));
    const std::optional<Car> car = car_of(world.drive[i]);
    if (car) face_ahead(state.heading(row), all.planes, preferred);
    if (const Route* route = state.route_of(row)) {  // a route already avoids static objects
      const OrcaAgent inner{state.pose[row].position(), agent.velocity, route->wall_radius};
      avoid_obstacles(std::min(options.timeHorizonObst, kRouteHorizon), world, fixed, inner, i, speed, ahead, all);
    } else {
      avoid_obstacles(options.timeHorizonObst, world, fixed, agent, i, speed, ahead, all);
    }
    const int hard = static_cast<int>(all.planes.size());
    if (reciprocity != nullptr) reciprocity->begin(k, self);
    // Ties are of origins, which are not always the centres.
    const double off = 2.0 * all.off_origin;
    const TieWay tie_way = breaks ? TieWay(agent.position, way, far, speed, off, options.neighborDist) : TieWay();
    const Ties ties = avoid_movers(options, world, state, decision.w(), self, speed, ahead, tie_way, reciprocity, all);
    if (ties.any && reciprocity != nullptr) reciprocity->tied();
    if (ties.on_line) preferred = keep_right(preferred, kLeanTurn);
    Vec2 velocity;
    bool free = choose_velocity(all.planes.data(), static_cast<int>(all.planes.size()), hard, speed, preferred,
                                all.scratch, velocity);
    if (is_slower(velocity, preferred) && options.sidestep.value_or(1.0) != 0.0) {
      const Vec2 wanted = preferred * (1.0 / norm(preferred));
      if (stands_ahead(options, world, state, decision.w(), self, wanted, speed, far, all)) {
        preferred = keep_right(preferred, std::copysign(kLeanTurn, options.sidestep.value_or(1.0)));
        free = choose_velocity(all.planes.data(), static_cast<int>(all.planes.size()), hard, speed, preferred,
                               all.scratch, velocity);
      }
    }
    const double same = coasts(world.drive[i]) ? kMinSpeed * kMinSpeed : 0.0;
    Turning turning = turning_for(world, state, row, squared(velocity - preferred) > same);
    // The heading may lead into a wall even if the wanted velocity does not.
    if (hard > 0) turning.max_forward = fastest_along(state.heading(row), all.planes.data(), hard);
    // One that stands and may not roll ahead turns by any error: nothing else would ever free it.
    if (turning.max_forward < kMinSpeed && squared(agent.velocity) < kMinSpeed * kMinSpeed) turning.tolerance = 0.0;
    if (car) {
      Vec3 control;
      const double ahead = std::min(norm(velocity), turning.max_forward);
      const bool stuck = ahead < kStuckShare * norm(preferred) && state.vel_min[row][0] < 0.0;
      if (!stuck || !back_off(*car, world, state, row, speed, hard, ahead, preferred, all, control)) {
        control = car_control(*car, world, state, row, velocity, turning.max_forward);
      }
      intents[k] = Intent::of_control(control);
    } else {
      intents[k] = Intent::of_velocity(velocity, turning);
    }
    intents[k].infeasible = !free;
  }
}

}  // namespace irsim
