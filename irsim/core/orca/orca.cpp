// The behavior `orca`: for each member the half-planes of what it avoids, and the best velocity within them.
#include "behaviors/orca.hpp"

#include <algorithm>

#include "geometry/predicates.hpp"
#include "orca/crowd.hpp"
#include "orca/obstacles.hpp"
#include "world/spec.hpp"

namespace irsim {
namespace {

constexpr double kLeastSpeed = 1e-6;   // slower wishes are rounding [m/s]
constexpr double kRouteHorizon = 0.5;  // on a route, farther ahead walls are its business [s]
constexpr double kCarAngle = 1.2;      // farther off its heading a car does not look for a velocity [rad]
constexpr double kCarStuck = 0.1;      // share of its speed below which a car backs off
constexpr double kCarBack = 0.3;       // share of its speed at which it wants to back off
constexpr double kCarTurn = 0.5;       // largest steering angle while it backs off [rad]
constexpr double kCarCreep = 0.2;      // least share of a wanted speed at which a car drives on to be able to turn

/// Fastest speed in every direction, or forward for drives that cannot move sideways [m/s].
double top_speed(const OrcaOptions& options, const World& world, int object) {
  const Vec3& top = world.vel_max[object];
  const Drive& drive = world.drive[object];
  const bool sideways = std::holds_alternative<OmniOptions>(drive) || std::holds_alternative<OmniAngularOptions>(drive);
  const double own = sideways ? std::min(top[0], top[1]) : top[0];
  return std::max(0.0, options.maxSpeed ? std::min(*options.maxSpeed, own) : own);
}

/// Full speed to the goal; nothing without one, or within `goal_threshold` of it. As in IR-SIM, an `omni` drive with
/// unequal limits leans toward the axis of the world that has the larger one.
Vec2 preferred_velocity(const World& world, const State& state, int row, int object, double speed) {
  const Goal& goal = state.destination(row);
  if (std::isnan(goal.x)) return {};
  Vec2 way = goal.position() - state.pose[row].position();
  const double distance = norm(way);
  if (!(distance > 0.0 && distance >= world.goal_threshold[object])) return {};
  const Vec3& top = world.vel_max[object];
  if (top[0] == top[1] || !std::holds_alternative<OmniOptions>(world.drive[object])) return way * (speed / distance);
  way = {way.x * top[0], way.y * top[1]};
  const double length = norm(way);
  return length > 0.0 ? way * (speed / length) : Vec2{};
}

/// How a drive that cannot move sideways turns. Small changes of direction and slow wishes are left out, as in IR-SIM,
/// but for those that avoid somebody: the next step starts from the true velocity and would ask for the same again.
Turning turning_for(const World& world, int object, bool avoiding) {
  Turning turning;
  turning.guarantee_time = world.step_time;
  turning.max_rate = world.vel_max[object][1];
  if (avoiding) turning.min_speed = kLeastSpeed, turning.tolerance = 0.0;
  return turning;
}

/// A car, which turns only while it rolls: it looks for velocities on either side of its heading only, and wants to go
/// as far to the side of the goal as that allows. `planes` is empty before; zero is in both.
void face_ahead(Vec2 heading, std::vector<HalfPlane>& planes, Vec2& preferred) {
  const Vec2 most = unit(kCarAngle), left = rotate(heading, most), right = rotate(heading, {most.x, -most.y});
  planes.push_back({{}, right});
  planes.push_back({{}, left * -1.0});
  const bool ahead = planes[0].depth(preferred) >= 0.0 && planes[1].depth(preferred) >= 0.0;
  if (!ahead) preferred = (cross(heading, preferred) > 0.0 ? left : right) * norm(preferred);
}

/// Controls of a car that shall go with `velocity`: steering acts from the next period on, and is then set such that
/// the heading is right at its end.
Vec3 car_control(const AckerOptions& car, const World& world, const State& state, int row, Vec2 velocity, double most) {
  const double speed = norm(velocity), dt = world.step_time, psi = state.extra[std::size_t(row) * state.extra_rows];
  const double wheelbase = car.wheelbase > 0.0 ? car.wheelbase : 1.0;
  Vec3 control;
  double target = psi;
  if (speed > kLeastSpeed) {
    const Vec2 heading = state.heading(row);
    control[0] = std::min(std::max(dot(heading, velocity), kCarCreep * speed), most);
    const double rolling = std::max(control[0], kCarCreep * kCarCreep);
    const double error = std::atan2(cross(heading, velocity), dot(heading, velocity));
    target = std::atan(error * wheelbase / (rolling * dt) - std::tan(psi) * control[0] / rolling);
  }
  control[1] = car.mode == Steering::steer ? target : (target - psi) / dt;
  return control;
}

/// Fastest speed along `direction` that stays within planes that zero is in [m/s].
double fastest_along(Vec2 direction, const HalfPlane* planes, int count) {
  double most = kInfinity;
  for (int k = 0; k < count; ++k) {
    const double rate = cross(planes[k].direction, direction);
    if (rate < 0.0) most = std::min(most, std::max(0.0, -planes[k].depth({}) / rate));
  }
  return most;
}

/// Controls of a car whose way ahead is blocked: back as far as what is behind allows, turning toward `preferred`.
/// False when that is no faster than `ahead` [m/s]. The first two planes are those of `face_ahead`, which are turned
/// round.
bool back_off(const AckerOptions& car, const World& world, const State& state, int row, double speed, int hard,
              double ahead, Vec2 preferred, OrcaCrowd& all, Vec3& control) {
  const Vec2 heading = state.heading(row), behind = heading * -1.0;
  for (int k = 0; k < 2; ++k) all.planes[k].direction = all.planes[k].direction * -1.0;
  Vec2 found;
  choose_velocity(all.planes.data(), static_cast<int>(all.planes.size()), hard, speed, behind * (kCarBack * speed),
                  all.scratch, found);
  const double back = std::min(dot(found, behind), fastest_along(behind, all.planes.data(), hard));
  if (back <= ahead) return false;
  const double psi = state.extra[static_cast<std::size_t>(row) * state.extra_rows];
  const double target = -clip(std::atan2(cross(heading, preferred), dot(heading, preferred)), -kCarTurn, kCarTurn);
  control = {{-back, car.mode == Steering::steer ? target : (target - psi) / world.step_time, 0.0}};
  return true;
}

/// Whether `viewer` is shown an object of another group.
bool shown(const World& world, int viewer, int other) {
  const int wanted = world.target_roles[viewer];
  return wanted == 0 || (wanted == 1) == (world.is_robot[other] != 0);
}

/// Half-planes of walls and standing circles: nearest edges first, those that others cover left out.
void avoid_obstacles(double horizon, const World& world, const Obstacles& obstacles, const OrcaAgent& agent, int object,
                     double speed, OrcaCrowd& all) {
  if (obstacles.empty()) return;
  const double reach = horizon * speed + agent.radius;
  const int edges = static_cast<int>(obstacles.edges.size());
  std::vector<HalfPlane>& planes = all.planes;
  all.edges.clear();
  all.neighbors.clear();  // the discs
  obstacles.near(box_around(agent.position, reach), [&](int k) {
    if (k >= edges) {
      const StandingDisc& disc = obstacles.discs[k - edges];
      const double gap = norm(disc.centre - agent.position) - disc.radius;
      if (gap < reach && shown(world, object, disc.object)) all.neighbors.push_back({gap, k - edges});
      return;
    }
    const Edge& edge = obstacles.edges[k];
    if (!edge.faces(agent.position) || (edge.object >= 0 && !shown(world, object, edge.object))) return;
    const Vec2 nearest = nearest_on_segment(edge.left.point, edge.right.point, agent.position);
    const double distance2 = squared(nearest - agent.position);
    if (distance2 < reach * reach) all.edges.push_back({distance2, k});
  });
  const auto covered = [&](Vec2 a, Vec2 b, double radius) {
    return std::any_of(planes.begin(), planes.end(),
                       [&](const HalfPlane& plane) { return covers(plane, agent, a, b, radius, horizon); });
  };
  std::sort(all.edges.begin(), all.edges.end());
  for (const Nearest::Found& found : all.edges) {
    const Edge& edge = obstacles.edges[found.index];
    HalfPlane plane;
    if (covered(edge.left.point, edge.right.point, agent.radius)) continue;
    if (avoid_edge(agent, edge, horizon, plane)) planes.push_back(plane);
  }
  std::sort(all.neighbors.begin(), all.neighbors.end());
  for (const Nearest::Found& found : all.neighbors) {
    const StandingDisc& disc = obstacles.discs[found.index];
    if (covered(disc.centre, disc.centre, agent.radius + disc.radius)) continue;
    planes.push_back(avoid_disc(agent, disc.centre, disc.radius, horizon));
  }
}

/// Half-planes of the nearest movers.
void avoid_movers(const OrcaOptions& options, const World& world, int self, OrcaCrowd& all) {
  const int object = world.moving[self], group = all.member_of[self];
  const OrcaAgent& agent = all.movers[self];
  const int most = std::min(options.maxNeighbors, static_cast<int>(all.movers.size()) - 1);
  if (most <= 0) return;
  if (static_cast<int>(all.neighbors.size()) < most) all.neighbors.resize(most);
  const auto seen = [&](int m) {
    return m != self && (all.member_of[m] == group || shown(world, object, world.moving[m]));
  };
  const int count = all.nearest.find(agent.position, options.neighborDist, most, seen, all.neighbors.data());
  for (int k = 0; k < count; ++k) {
    const int m = all.neighbors[k].index;
    // who follows orders, stands stopped or is not shown this one does not give way
    const bool mutual = all.group[m] >= 0 && (all.group[m] == group || shown(world, world.moving[m], object));
    all.planes.push_back(
        avoid_agent(agent, all.movers[m], mutual ? 0.5 : 1.0, options.timeHorizon, world.step_time, self < m));
  }
}

}  // namespace

void orca(const OrcaOptions& options, const Decision& decision, Intent* intents) {
  const World& world = decision.world;
  const State& state = decision.state;
  const Scene& scene = state.scenes[decision.w()];
  const Obstacles& obstacles = scene.fixed->obstacles;
  OrcaCrowd& all = crowd(world, state, decision.work, decision.w());
  for (int k = 0; k < decision.count; ++k) {
    const int i = decision.objects[k], row = decision.row(k), self = scene.shapes->placed[i].object;
    const OrcaAgent& agent = all.movers[self];
    const double speed = top_speed(options, world, i);
    all.planes.clear();
    Vec2 preferred = preferred_velocity(world, state, row, i, speed);
    const auto* car = std::get_if<AckerOptions>(&world.drive[i]);
    if (car != nullptr) face_ahead(state.heading(row), all.planes, preferred);
    if (const Route* route = state.route_of(row)) {  // which leads past what stands still
      const OrcaAgent inner{state.pose[row].position(), agent.velocity, route->wall_radius};
      avoid_obstacles(std::min(options.timeHorizonObst, kRouteHorizon), world, obstacles, inner, i, speed, all);
    } else {
      avoid_obstacles(options.timeHorizonObst, world, obstacles, agent, i, speed, all);
    }
    const int hard = static_cast<int>(all.planes.size());
    avoid_movers(options, world, self, all);
    Vec2 velocity;
    const bool free = choose_velocity(all.planes.data(), static_cast<int>(all.planes.size()), hard, speed, preferred,
                                      all.scratch, velocity);
    Turning turning = turning_for(world, i, squared(velocity - preferred) > 0.0);
    // the way it faces may lead into a wall even if the way it wants to go does not
    if (hard > 0) turning.max_forward = fastest_along(state.heading(row), all.planes.data(), hard);
    if (car != nullptr) {
      Vec3 control;
      const double ahead = std::min(norm(velocity), turning.max_forward);
      const bool stuck = ahead < kCarStuck * norm(preferred) && world.vel_min[i][0] < 0.0;
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
