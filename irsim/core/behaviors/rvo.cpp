#include "behaviors/rvo.hpp"

#include "rvo/velocity_obstacles.hpp"
#include "surroundings/closing.hpp"
#include "surroundings/ego.hpp"
#include "surroundings/passing.hpp"
#include "surroundings/sidestep.hpp"
#include "surroundings/ties.hpp"

namespace irsim {
namespace {

constexpr double kSpacing = 0.05;     // spacing of the search grid [m/s]
constexpr double kMinLength = 1e-6;   // shorter segments are skipped [m]
constexpr double kThinAngle = 0.01;   // replaces an angle of zero in the apex of hrvo [rad]
constexpr double kWallHorizon = 1.0;  // walls that would be reached sooner block a velocity [s]
constexpr double kSameSample = 1e-9;  // two squared distances of samples differ by more [m^2/s^2]
constexpr double kWallMargin = 1e-6;  // of the tangents of walls, so that rounding does not hide a wall beside one [m]
constexpr double kSlowest = 1e-3;     // slower velocities near walls are rounding errors [m/s]
constexpr double kTieMemory = 1.0;    // a tie lasts that long, while the objects are almost mirrored [s]
constexpr double kAlmostTied = 0.05;  // largest difference of their directions to the goals then
constexpr double kMinRolling = 0.2;   // smallest share of the speed at which drives roll while they turn

/// The apex of the cone of a disc. `sine` and `cosine` belong to half its angle.
Vec2 apex_of(Avoidance mode, const Ego& ego, const Disc& disc, const Cone& cone, double sine, double cosine) {
  const Vec2 middle = (ego.velocity + disc.velocity) * 0.5;
  if (mode == Avoidance::vo) return disc.velocity;
  if (mode == Avoidance::rvo) return middle;
  const double opening = cosine > 0.0 ? 2.0 * sine * cosine : std::sin(kThinAngle);
  const double shift = cross(middle - disc.velocity, cone.left) / opening;
  const bool on_the_right = cross(disc.centre - ego.position, ego.velocity - middle) <= 0.0;
  return on_the_right ? middle - cone.right * shift : disc.velocity + cone.right * shift;
}

void add_disc(const RvoOptions& options, const Ego& ego, const Disc& disc, VelocityObstacles& obstacles) {
  const Vec2 way = disc.centre - ego.position;
  const double radius = ego.radius + disc.radius + kPadding, distance = norm(way);
  const double sine = radius / std::max(distance, radius), cosine = std::sqrt(std::max(1.0 - sine * sine, 0.0));
  const Vec2 towards = distance > 0.0 ? way * (1.0 / distance) : Vec2{1.0, 0.0};
  Cone cone{{}, rotate(towards, {cosine, sine}), rotate(towards, {cosine, -sine})};
  cone.apex = apex_of(options.mode, ego, disc, cone, sine, cosine);
  obstacles.cones.push_back(cone);
  const double gap2 = std::max(distance * distance - radius * radius, 0.0);
  obstacles.approaches.push_back({ego.velocity + disc.velocity, std::sqrt(gap2), 1.0 / gap2});
}

/// Add the cone between the ends of a segment, widened by the radius of the ego at both.
void add_line(const Ego& ego, Vec2 a, Vec2 b, VelocityObstacles& obstacles) {
  a = a - ego.position, b = b - ego.position;
  const double length = norm(b - a);
  if (length < kMinLength) return;
  if (cross(a, b) < 0.0) std::swap(a, b);
  const auto edge = [&](Vec2 end, double side) {
    const double distance = norm(end);
    if (distance <= kMinLength) return rotate(unit(0.0), {0.0, side});
    const double sine = std::min(1.0, ego.radius / std::max(distance, ego.radius));
    return rotate(end * (1.0 / distance), {std::sqrt(1.0 - sine * sine), side * sine});
  };
  obstacles.cones.push_back({{}, edge(b, 1.0), edge(a, -1.0)});
  obstacles.stretches.push_back({a, (b - a) * (1.0 / length), length, ego.radius});
}

/// Collect everything to avoid. Returns whether the ego and another object are mirror images of each other.
bool look_around(const RvoOptions& options, const Decision& decision, const Ego& ego, VelocityObstacles& obstacles) {
  bool meets = false;
  obstacles.clear();
  obstacles.horizon = kWallHorizon;
  const double room = ego.route != nullptr ? ego.route->wall_radius : ego.radius;  // distance to keep from walls [m]
  WallView& walls = obstacles.walls;
  const double fastest = norm({options.vxmax, options.vymax}) * ego.pace;
  const bool gaps = keeps_gaps(decision, ego, options.keep_gap);
  const double body = ego.radius - kPadding, ahead = fastest * decision.world.step_time / kClosingShare;
  decision.work.nearby.clear();
  std::int64_t& last = decision.tied[ego.row];
  const std::int64_t now = decision.state.count[decision.w()];
  const bool lately = last >= 0 && static_cast<double>(now - last) * decision.world.step_time <= kTieMemory;
  const double direction = lately ? kAlmostTied : kTieDirection;
  for_discs(decision, ego, options.neighbor_threshold, [&](const Disc& disc) {
    const bool stands = decision.world.is_static[disc.object];
    if (ego.route == nullptr || !stands) {
      add_disc(options, ego, disc, obstacles);
      if (gaps && may_close(disc.centre - ego.position, body + disc.radius, ahead)) add_nearby(decision, ego, disc);
      if (!options.sidestep && !meets)
        meets = tied(decision, ego, disc, options.neighbor_threshold, kTieSpeed, direction);
    } else if (!decision.world.unobstructed[disc.object]) {
      const Vec2 centre = disc.centre - ego.position;
      walls.barriers.emplace_back(centre, centre, room + disc.radius);
    }
  });
  if (meets) last = now;
  if (!walls.barriers.empty()) walls.fronts.emplace_back().last = static_cast<int>(walls.barriers.size());
  const double reach = std::min(options.neighbor_threshold, room + fastest * kWallHorizon);
  for_moving_lines(decision, ego, [&](Vec2 a, Vec2 b) { add_line(ego, a, b, obstacles); });
  // A route already leads past walls.
  const double goal = norm(decision.state.destination(ego.row).position() - ego.position);
  const bool wants = ego.route == nullptr && squared(ego.desired) > 0.0;
  const double look = wants ? std::min(goal, options.neighbor_threshold) : 0.0;
  add_walls(decision, ego.id, ego.position, room, reach, look, kWallMargin, ego.route == nullptr, walls);
  return meets;
}

/// Samples about a speed; only the nearest limit if the speed exceeds it by more than the window.
Axis window(double speed, double acce, double limit) {
  const Axis axis = Axis::arange(std::max(speed - acce, -limit), std::min(speed + acce, limit), kSpacing);
  return axis.count > 0 ? axis : Axis{clip(speed, -limit, limit), kSpacing, 1};
}

template <class Drive>
constexpr bool moves_sideways(const Drive&) {
  return false;
}
constexpr bool moves_sideways(const OmniOptions&) { return true; }
constexpr bool moves_sideways(const OmniAngularOptions&) { return true; }

/// Largest speed along the heading at which no wall is hit [m/s]. It matters for drives that cannot move sideways,
/// because they roll along their heading while they turn.
double free_speed(const VelocityObstacles& obstacles, Vec2 velocity, Vec2 heading) {
  const double rolling = std::max(dot(velocity, heading), kMinRolling * norm(velocity));
  double speed = kInfinity;
  for (const Barrier& wall : obstacles.walls.barriers) {
    const double share = wall.time(heading * rolling) / obstacles.horizon;
    if (share < 1.0) speed = std::min(speed, rolling * share);
  }
  return speed;
}

/// Whether the chosen velocity is not the sample nearest to the wanted one.
bool avoids(const Axis& x, const Axis& y, Vec2 chosen, Vec2 wanted) {
  const Vec2 nearest{x.at(x.nearest(wanted.x)), y.at(y.nearest(wanted.y))};
  return squared(chosen - wanted) > squared(nearest - wanted) + kSameSample;
}

/// How a drive turns to a velocity that avoids something. The next step would ask for the same turn again, so a small
/// one is made, too, and the drive has time for each.
Turning sharp_turning(const Decision& decision, const Ego& ego) {
  Turning turning;
  turning.tolerance = 0.0;
  turning.guarantee_time = decision.world.step_time;
  turning.max_rate = decision.state.vel_max[ego.row][1];
  return turning;
}

Intent turning_intent(const VelocityObstacles& obstacles, const Ego& ego, Vec2 velocity, Vec2 heading,
                      Turning turning) {
  // Nearly parallel to a wall still ends in the wall, and what is slow there is no rounding error.
  if (ego.route != nullptr || !obstacles.walls.barriers.empty()) turning.tolerance = 0.0;
  if (ego.route == nullptr && !obstacles.walls.barriers.empty()) turning.min_speed = kSlowest;
  if (norm(velocity) <= turning.min_speed) {
    const bool alone = obstacles.cones.empty();
    turning.max_forward = 0.0;
    return Intent::of_velocity(alone ? ego.desired : Vec2{}, turning);
  }
  turning.max_forward = free_speed(obstacles, velocity, heading);
  return Intent::of_velocity(velocity, turning);
}

}  // namespace

void rvo(const RvoOptions& options, const Decision& decision, Intent* intents) {
  VelocityObstacles& obstacles = decision.work.velocity_obstacles;
  for (int k = 0; k < decision.count; ++k) {
    Ego ego = ego_of(decision, k);
    ego.desired = past_walls(decision, k, ego.position, ego.radius, options.neighbor_threshold, ego.desired, true);
    ego.desired = sidestepped(decision, k, ego.desired, options.sidestep.value_or(0.0));
    if (look_around(options, decision, ego, obstacles)) ego.desired = keep_right(ego.desired, kTieTurn);
    const Vec2 v = ego.velocity;
    const Axis x = window(v.x, options.acce, options.vxmax * ego.pace);
    const Axis y = window(v.y, options.acce, options.vymax * ego.pace);
    const Vec2 velocity = best_sample(obstacles, x, y, ego.desired, options.factor);
    const bool sharp = options.turning == RvoTurning::limit && avoids(x, y, velocity, ego.desired);
    const Turning turning = sharp ? sharp_turning(decision, ego) : Turning{};
    const bool sideways =
        std::visit([](const auto& drive) { return moves_sideways(drive); }, decision.world.drive[ego.id]);
    intents[k] = sideways ? Intent::of_velocity(velocity)
                          : turning_intent(obstacles, ego, velocity, decision.state.heading(ego.row), turning);
    if (!decision.work.nearby.empty()) keep_gaps(decision, ego, false, intents[k]);
  }
}

}  // namespace irsim
