#include "drive.hpp"
#include "orca/half_planes.hpp"
#include "routes/follower.hpp"
#include "routes/right_of_way.hpp"
#include "routes/sides.hpp"
#include "world/features.hpp"

namespace irsim {
namespace {

constexpr double kSideMargin = 0.01;  // distance that objects keep from the line between them [m]
constexpr double kReachSlack = 0.1;   // objects farther away than they can drive, and this, have no line [m]
constexpr double kMinSlide = 0.1;     // share of the wanted speed for which it is worth turning along a line
constexpr double kMinTurn = 0.02;     // smaller turns are not worth it [rad]
constexpr double kRounding = 1e-9;    // [m]

bool moves_sideways(const Drive& drive) {
  return std::holds_alternative<OmniOptions>(drive) || std::holds_alternative<OmniAngularOptions>(drive);
}

/// How far a hull reaches in a direction [m].
double support(const Hull& hull, Vec2 normal) { return hull.round - hull.least(normal * -1.0); }

/// Whether an object looks at the line to another one as this looks at the line to it: both then find the same line.
bool looks_first(const Pose& here, const Pose& there) {
  return here.x != there.x ? here.x < there.x : here.y < there.y;
}

}  // namespace

double Follower::range(int object) const {
  const int row = w_ * world_.objects + object;
  const Vec3 &top = state_.vel_max[row], &least = state_.vel_min[row], &acce = state_.acce[row];
  const double speed = std::max(std::fabs(top[0]), std::fabs(least[0]));
  const double braking = std::isfinite(acce[0]) && acce[0] > 0.0 ? 0.5 * speed * speed / acce[0] : 0.0;
  const double along = 2.0 * speed * world_.step_time + braking;
  if (!moves_sideways(world_.drive[object]) || !glides(world_, state_, row, object)) return along;
  const double aside = std::max(std::fabs(top[1]), std::fabs(least[1]));
  const double stop = std::isfinite(acce[1]) && acce[1] > 0.0 ? 0.5 * aside * aside / acce[1] : 0.0;
  return norm({along, 2.0 * aside * world_.step_time + stop});
}

Ahead Follower::ahead_of(int object) const {
  const double reach = norm(shapes_.centre[object]) + shapes_.radius[object];
  return {world_, state_, w_ * world_.objects + object, object, reach, work_.extra};
}

int Follower::stop_of(int object) {
  StopHulls& hulls = work_.stop_hulls;
  if (hulls.stop[object] >= 0) return hulls.stop[object];
  const int row = w_ * world_.objects + object;
  const Vec2 place = state_.pose[row].position();
  hulls.all.add(shapes_, object, place, state_.heading(row));
  hulls.body[object] = hulls.stop[object] = hulls.all.count() - 1;
  if (follows_route(world_, state_, w_, object) && glides(world_, state_, row, object)) {
    ahead_of(object).stop(hulls.way);
    if (hulls.way.moves() || hulls.way.bulge > 0.0) {
      hulls.all.add(hulls.all[hulls.body[object]], place, hulls.way);
      hulls.stop[object] = hulls.all.count() - 1;
    }
  }
  return hulls.stop[object];
}

double Follower::strip_between_stops(int other, Side& side) {
  const int mine = stop_of(object_), its = stop_of(other);
  const Hull own = work_.stop_hulls.all[mine], there = work_.stop_hulls.all[its];
  const bool first = looks_first(state_.pose[row_], state_.pose[w_ * world_.objects + other]);
  const Separation apart = first ? separation(own, there) : mirrored_separation(own, there);
  side.normal = apart.axis * -1.0;
  side.offset = support(own, side.normal);
  return apart.gap;
}

void Follower::find_sides() {
  std::vector<Side>& sides = work_.sides;
  sides.clear();
  const double own = range(object_);
  const Footprint body = state_.scenes[w_].moving.footprint(shapes_, object_);
  for (const int other : world_.moving) {
    if (other == object_ || world_.unobstructed[other]) continue;
    const int row = w_ * world_.objects + other;
    const bool follows = follows_route(world_, state_, w_, other);
    const bool glide = glides_ || (follows && glides(world_, state_, row, other));
    const double reach = own + (glide && follows ? std::max(own, range(other)) : own) + kReachSlack;
    const Footprint there = state_.scenes[w_].moving.footprint(shapes_, other);
    if (norm(there.centre - body.centre) > body.radius + there.radius + reach) continue;
    Side side{{}, 0.0};
    double width = glide ? strip_between_stops(other, side) : -1.0;
    if (!(width >= 0.0)) width = widest_strip(body, there, side.normal), side.offset = support(body, side.normal);
    if (!(width >= 0.0)) continue;
    double mine = 0.5 * width - kSideMargin;
    if (!follows) {
      mine = width - kSideMargin;
      if (!state_.stopped[row])
        mine -= std::max(0.0, -dot(velocity_world(world_, state_, row), side.normal)) * world_.step_time;
    }
    side.offset += std::max(mine, 0.0) + kRounding;
    sides.push_back(side);
  }
}

bool Follower::stays_on_sides(const Vec3& command) {
  if (work_.sides.empty()) return true;
  stop_of(object_);
  StopHulls& hulls = work_.stop_hulls;
  const Ahead ahead = ahead_of(object_);
  ahead.step_and_stop(ahead.limited(command), hulls.way);
  const Hull body = hulls.all[hulls.body[object_]];
  const Vec2 from = position();
  return std::all_of(work_.sides.begin(), work_.sides.end(), [&](const Side& side) {
    const double most = side.offset - body.round - hulls.way.bulge - dot(side.normal, from);
    return std::all_of(hulls.way.places.begin() + 1, hulls.way.places.end(), [&](const Place& place) {
      const Vec2 normal = unrotate(side.normal, place.turn);
      double far = -kInfinity;
      for (int k = 0; k < body.count; ++k) far = std::max(far, dot(normal, body.corner[k] - from));
      return far + dot(side.normal, place.shift) <= most;
    });
  });
}

std::optional<Vec3> Follower::along_sides(const Vec3& u) {
  const bool sideways = moves_sideways(world_.drive[object_]);
  const Vec2 heading = state_.heading(row_), wanted = rotate({u[0], sideways ? u[1] : 0.0}, heading);
  const Footprint body = state_.scenes[w_].moving.footprint(shapes_, object_);
  std::vector<HalfPlane> planes, scratch;
  for (const Side& side : work_.sides) {
    const double left = std::max(0.0, side.offset - support(body, side.normal) - 2 * kRounding);
    const double most =
        std::min(left / world_.step_time, speed_to_stop_within(left, state_.acce[row_][0], world_.step_time));
    planes.push_back({side.normal * most, {-side.normal.y, side.normal.x}});
  }
  const int count = static_cast<int>(planes.size());
  Vec2 velocity;
  if (!choose_velocity(planes.data(), count, count, norm(wanted), wanted, scratch, velocity)) return std::nullopt;
  Vec3 v = u;
  if (sideways) {
    const Vec2 control = unrotate(velocity, heading);
    v[0] = control.x, v[1] = control.y;
    return v;
  }
  if (!(u[0] > 0.0) || !(norm(velocity) > kMinSlide * norm(wanted))) return std::nullopt;
  const double error = std::atan2(cross(heading, velocity), dot(heading, velocity));
  const double most = std::fabs(state_.vel_max[row_][1]);
  v[0] = 0.0, v[1] = clip(error / world_.step_time, -most, most);
  return std::fabs(error) > kMinTurn ? std::optional<Vec3>(v) : std::nullopt;
}

void Follower::keep_apart(Vec3& u) {
  if (std::holds_alternative<DashOptions>(world_.specs[object_].behavior) ||
      std::holds_alternative<std::monostate>(world_.drive[object_]))
    return;
  find_sides();
  if (work_.sides.empty() || clear_after(u)) return work_.sides.clear();
  const std::optional<Car> car = car_of(world_.drive[object_]);
  const bool sideways = moves_sideways(world_.drive[object_]);
  bool found = false;
  const auto attempt = [&](const Vec3& command) {
    if (found || !clear_after(command)) return;
    u = command;
    found = true;
  };
  const Vec3 wanted = u;
  const auto slowed = [&](double share, double turn) {
    Vec3 v = wanted;
    v[0] *= share;
    v[1] *= sideways ? share : turn;
    v[2] *= turn;
    return v;
  };
  if (!car) {
    if (const std::optional<Vec3> along = along_sides(u)) attempt(*along);
  }
  for (const double turn : {1.0, 0.0}) {
    for (const double share : {0.5, 0.25, 0.1, 0.0}) {
      if (!car || share > 0.0) attempt(slowed(share, car ? 1.0 : turn));
    }
  }
  if (!found) {
    u = slowed(0.0, car ? 1.0 : 0.0);
    if (car) {  // whichever way it is to leave, one of both steerings may be free: straight, or as wanted
      const double psi = state_.extra[static_cast<std::size_t>(row_) * state_.extra_rows];
      if (std::fabs(psi) > kRounding) u[1] = car->mode == Steering::steer ? 0.0 : -psi / world_.step_time;
    }
    if (glides_ && !stays_on_sides(u)) u = braking();
  }
  work_.sides.clear();
  if (!found && car) hold_steering(u);
}

}  // namespace irsim
