#include "behaviors/sfm.hpp"

#include "geometry/predicates.hpp"
#include "surroundings/closing.hpp"
#include "surroundings/ego.hpp"
#include "surroundings/passing.hpp"
#include "surroundings/sidestep.hpp"
#include "surroundings/ties.hpp"

namespace irsim {
namespace {

constexpr double kOnWall = 1e-9;    // an object this close is on the wall [m]
constexpr double kWallReach = 5.0;  // distance within which walls act, in units of sigma
constexpr double kSideways = 0.2;   // largest push of walls across a route, as a share of the pull along it
constexpr double kAgainst = 0.5;    // largest push of walls against a way that is free, as a share of the pull along it
constexpr double kTolerance = 0.02;  // smaller heading errors are not corrected [rad]
constexpr double kSameSpeed = 1e-6;  // velocities of a mirrored pair differ by less [m/s]

bool same(Vec2 a, Vec2 b) { return a.x == b.x && a.y == b.y; }

/// Sum of the forces of other discs on object k of the decision. A force that is known from the other's decision is not
/// computed again.
Vec2 social_force(const SfmOptions& o, const Decision& decision, int k, const Ego& ego) {
  const World& world = decision.world;
  SocialForces& forces = decision.work.social_forces;
  MutualForces& mutual = decision.work.mutual_forces;
  const Scene& scene = decision.state.scenes[decision.w()];
  const Neighbors& near = neighbors(world, decision.state, decision.work, decision.w());
  const bool gaps = keeps_gaps(decision, ego, o.keep_gap);
  const double body = ego.radius - kPadding, ahead = o.vmax * ego.pace * world.step_time / kClosingShare;
  // At rest no force has shown yet whether what surrounds a pair is mirrored, too.
  const bool breaks_ties = !o.sidestep && squared(ego.velocity) > 0.0;
  decision.work.nearby.clear();
  mutual.decide(k);
  forces.clear(world.objects);
  for_discs(decision, ego, o.neighbor_threshold, [&](const Disc& other) {
    if (ego.route != nullptr && world.is_static[other.object]) return;
    if (gaps && may_close(other.centre - ego.position, body + other.radius, ahead)) add_nearby(decision, ego, other);
    if (mutual.knows(other.object)) return;
    if (breaks_ties && tied(decision, ego, other, o.neighbor_threshold, kSameSpeed)) mutual.tie(other.object);
    forces.add(other.centre - ego.position, ego.velocity - other.velocity);
    // Others see the ego where it sees itself: its origin is the centre of its disc, or they know its origin.
    const Vec2 origin = decision.state.pose[decision.first_row + other.object].position();
    mutual.expect(other.object, same(other.centre, origin));
  });
  forces.compute(o, ego.velocity);
  const bool centred = decision.grouped || same(near.discs[scene.shapes->placed[ego.id].object].centre, ego.position);
  return mutual.sum(ego.id, centred, forces);
}

/// Force of a wall, away from its nearest point.
Vec2 wall_force(const SfmOptions& o, const Ego& ego, Vec2 nearest) {
  const Vec2 away = ego.position - nearest;
  const double distance = norm(away);
  if (distance > kWallReach * o.sigma_obstacle + ego.radius) return {};
  if (distance < kOnWall) return {1.0, 0.0};
  return away * (std::exp(-std::max(distance - ego.radius, 0.0) / o.sigma_obstacle) / distance);
}

/// Whether the nearest point is the corner at which the next wall starts and that wall faces the ego. The force of the
/// corner is then computed with the next wall only.
bool shared_corner(const Walls& walls, const Wall& wall, Vec2 position) {
  if (wall.next < 0 || dot(position - wall.b, wall.b - wall.a) < 0.0) return false;
  const Wall& next = walls.list[wall.next];
  const Vec2 along = next.b - next.a;
  return cross(along, position - next.a) <= 0.0 && dot(position - next.a, along) <= 0.0;
}

/// The force of static objects on a route, which is free of them: only its sideways part, limited to less than the pull
/// along the route.
Vec2 on_route(const SfmOptions& o, const Ego& ego, Vec2 force) {
  const double speed = norm(ego.desired);
  if (!(speed > 0.0)) return {};
  const Vec2 ahead = ego.desired * (1.0 / speed), side{-ahead.y, ahead.x};
  const double most = kSideways * o.vmax * ego.pace * o.force_factor_desired / o.relaxation_time;
  return side * clip(dot(force, side) * o.force_factor_obstacle, -most, most) * (1.0 / o.force_factor_obstacle);
}

/// The force of walls that leave the way ahead free, such as the posts of a door, without the part against the wanted
/// velocity that would hold the object there: what is left is weaker than the pull to the goal.
Vec2 on_free_way(const SfmOptions& o, const Decision& decision, int k, const Ego& ego, Vec2 force) {
  const double speed = norm(ego.desired);
  const double most = kAgainst * o.vmax * ego.pace * o.force_factor_desired / o.relaxation_time;
  if (!(speed > 0.0 && most > 0.0)) return force;
  const Vec2 ahead = ego.desired * (1.0 / speed);
  const double excess = -dot(force, ahead) * o.force_factor_obstacle - most;
  if (!(excess > 0.0)) return force;
  if (!is_free_ahead(decision, k, ego.position, ego.radius - kPadding, kWallLook, ahead)) return force;
  return force + ahead * (excess / o.force_factor_obstacle);
}

Vec2 obstacle_force(const SfmOptions& o, const Decision& decision, int k, const Ego& ego) {
  Vec2 force, moving;
  const double reach = kWallReach * o.sigma_obstacle + ego.radius;
  const auto push = [&](Vec2 a, Vec2 b) { force = force + wall_force(o, ego, nearest_on_segment(a, b, ego.position)); };
  for_moving_lines(decision, ego, push);
  moving = force;
  if (ego.route != nullptr) force = {};
  const Walls& walls = decision.state.scenes[decision.w()].fixed->walls;
  for_facing_walls(decision, ego.id, ego.position, reach, [&](const Wall& wall) {
    if (ego.route != nullptr && decision.world.unobstructed[wall.object]) return;
    if (shared_corner(walls, wall, ego.position)) return;
    push(wall.a, wall.b);
  });
  if (ego.route == nullptr) {
    const Vec2 walls_alone = force - moving, limited = on_free_way(o, decision, k, ego, walls_alone);
    return same(limited, walls_alone) ? force : moving + limited;
  }
  for_discs(decision, ego, o.neighbor_threshold, [&](const Disc& disc) {
    if (!decision.world.is_static[disc.object] || decision.world.unobstructed[disc.object]) return;
    const Vec2 way = ego.position - disc.centre;
    force = force + wall_force(o, ego, disc.centre + way * std::min(1.0, disc.radius / std::max(norm(way), kOnWall)));
  });
  return moving + on_route(o, ego, force);
}

/// Forces between the members of one social group.
struct Companions {
  const SfmOptions& options;
  const Decision& decision;
  const std::vector<int>& positions;  // indices in Decision::members; larger ones are ignored

  template <class Visit>
  void each(Visit&& visit) const {
    for (const int position : positions) {
      if (position >= static_cast<int>(decision.members.size())) continue;
      const int id = decision.members[position], row = decision.first_row + id;
      if (decision.state.absent(row)) continue;
      const Scene& scene = decision.state.scenes[decision.w()];
      visit(id, decision.state.pose[row].position(), scene.shapes->radius[id] + kPadding);
    }
  }

  Vec2 force(const Ego& ego) const {
    Vec2 sum, repulsion;
    double size = 0.0;
    each([&](int id, Vec2 position, double radius) {
      sum = sum + position;
      size += 1.0;
      const Vec2 apart = ego.position - position;
      if (id != ego.id && norm(apart) < options.group_repulsion_threshold.value_or(ego.radius + radius)) {
        repulsion = repulsion + apart;
      }
    });
    if (size < 2.0) return {};
    const Vec2 to_middle = sum * (1.0 / size) - ego.position;
    const Vec2 to_others = (sum - ego.position) * (1.0 / (size - 1.0)) - ego.position;
    const Vec2 coherence = to_middle * (0.5 * (std::tanh(norm(to_middle) - 0.5 * (size - 1.0)) + 1.0));
    return coherence * options.force_factor_coherence + repulsion * options.force_factor_group_repulsion +
           gaze(ego, to_others) * options.force_factor_gaze;
  }

  /// Slow down if the others are out of view.
  Vec2 gaze(const Ego& ego, Vec2 to_others) const {
    const double lengths = norm(ego.velocity) * norm(to_others);
    if (!(lengths > 0.0)) return {};
    const double angle = std::acos(clip(dot(ego.velocity, to_others) / lengths, -1.0, 1.0));
    return ego.velocity * -std::max(angle - options.gaze_vision_angle * (kPi / 180.0), 0.0);
  }
};

Vec2 group_force(const SfmOptions& o, const Decision& decision, const Ego& ego) {
  if (!decision.grouped || !o.social_groups) return {};
  for (const std::vector<int>& positions : *o.social_groups) {
    for (const int position : positions) {
      if (position >= static_cast<int>(decision.members.size()) || decision.members[position] != ego.id) continue;
      return Companions{o, decision, positions}.force(ego);
    }
  }
  return {};
}

}  // namespace

void sfm(const SfmOptions& options, const Decision& decision, Intent* intents) {
  const World& world = decision.world;
  const double dt = world.step_time;
  decision.work.mutual_forces.begin(decision.objects, decision.count, world.objects);
  for (int k = 0; k < decision.count; ++k) {
    Ego ego = ego_of(decision, k);
    ego.desired = past_walls(decision, k, ego.position, ego.radius, kWallLook, ego.desired, true);
    ego.desired = sidestepped(decision, k, ego.desired, options.sidestep.value_or(0.0));
    const Vec2 social = social_force(options, decision, k, ego);
    if (decision.work.mutual_forces.tied()) ego.desired = keep_right(ego.desired, kTieTurn);
    const double speed = norm(ego.desired);
    const double most = options.vmax * ego.pace;
    const Vec2 desired = speed > 0.0 ? ego.desired * (most / speed) : Vec2{};
    const Vec2 force = (desired - ego.velocity) * (options.force_factor_desired / options.relaxation_time) +
                       social * options.force_factor_social +
                       obstacle_force(options, decision, k, ego) * options.force_factor_obstacle +
                       group_force(options, decision, ego);
    Vec2 velocity = ego.velocity + force * dt;
    // A car turns too slowly to follow one period of the forces, so on a route it steers where they lead in the end.
    if (ego.route != nullptr && steers(world.drive[ego.id])) {
      velocity = ego.velocity + force * options.relaxation_time;
    }
    const double fast = norm(velocity);
    if (fast > most) velocity = velocity * (most / fast);
    Turning turning;
    turning.tolerance = kTolerance;
    turning.guarantee_time = dt;
    turning.max_rate = decision.state.vel_max[ego.row][1];
    intents[k] = Intent::of_velocity(velocity, turning);
    if (!decision.work.nearby.empty()) keep_gaps(decision, ego, true, intents[k]);
  }
}

}  // namespace irsim
