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

}  // namespace

void Follower::find_sides() {
  std::vector<Side>& sides = work_.sides;
  sides.clear();
  const Vec3 &top = state_.vel_max[row_], &acce = state_.acce[row_];
  const double dt = world_.step_time, speed = std::max(std::fabs(top[0]), std::fabs(state_.vel_min[row_][0]));
  const double braking = std::isfinite(acce[0]) && acce[0] > 0.0 ? 0.5 * speed * speed / acce[0] : 0.0;
  const double reach = 2.0 * (2.0 * speed * dt + braking) + kReachSlack;
  const Footprint body = state_.scenes[w_].moving.footprint(shapes_, object_);
  for (const int other : world_.moving) {
    if (other == object_ || world_.unobstructed[other]) continue;
    const Footprint there = state_.scenes[w_].moving.footprint(shapes_, other);
    if (norm(there.centre - body.centre) > body.radius + there.radius + reach) continue;
    Vec2 normal;
    const double width = widest_strip(body, there, normal);
    if (!(width >= 0.0)) continue;
    const int row = w_ * world_.objects + other;
    double mine = 0.5 * width - kSideMargin;
    if (!follows_route(world_, state_, w_, other)) {
      mine = width - kSideMargin;
      if (!state_.stopped[row]) mine -= std::max(0.0, -dot(velocity_world(world_, state_, row), normal)) * dt;
    }
    sides.push_back({normal, support(body, normal) + std::max(mine, 0.0) + kRounding});
  }
}

void Follower::keep_apart(Vec3& u) {
  if (std::holds_alternative<DashOptions>(world_.specs[object_].behavior) ||
      std::holds_alternative<std::monostate>(world_.drive[object_]))
    return;
  find_sides();
  if (work_.sides.empty() || clear_after(u)) return work_.sides.clear();
  const bool sideways = std::holds_alternative<OmniOptions>(world_.drive[object_]) ||
                        std::holds_alternative<OmniAngularOptions>(world_.drive[object_]);
  const auto tried = [&](const Vec3& command) {
    if (!clear_after(command)) return false;
    u = command;
    return true;
  };
  const auto slowed = [&](double share, double turn) {
    Vec3 v = u;
    v[0] *= share;
    v[1] *= sideways ? share : turn;
    v[2] *= turn;
    return v;
  };
  bool found = false;
  const bool car = std::holds_alternative<AckerOptions>(world_.drive[object_]);
  if (!car) {  // slide along the lines
    const Vec2 heading = state_.heading(row_), wanted = rotate({u[0], sideways ? u[1] : 0.0}, heading);
    const Footprint body = state_.scenes[w_].moving.footprint(shapes_, object_);
    std::vector<HalfPlane> planes, scratch;
    for (const Side& side : work_.sides) {
      const double most = std::max(0.0, side.offset - support(body, side.normal) - 2 * kRounding) / world_.step_time;
      planes.push_back({side.normal * most, {-side.normal.y, side.normal.x}});
    }
    const int count = static_cast<int>(planes.size());
    Vec2 velocity;
    const bool chosen = choose_velocity(planes.data(), count, count, norm(wanted), wanted, scratch, velocity);
    Vec3 v = u;
    if (chosen && sideways) {
      const Vec2 control = unrotate(velocity, heading);
      v[0] = control.x, v[1] = control.y;
      found = tried(v);
    } else if (chosen && u[0] > 0.0 && norm(velocity) > kMinSlide * norm(wanted)) {  // turn there before driving
      const double error = std::atan2(cross(heading, velocity), dot(heading, velocity));
      const double most = std::fabs(state_.vel_max[row_][1]);
      v[0] = 0.0, v[1] = clip(error / world_.step_time, -most, most);
      found = std::fabs(error) > kMinTurn && tried(v);
    }
  }
  for (const double turn : {1.0, 0.0}) {
    for (const double share : {0.5, 0.25, 0.1, 0.0}) {
      if (!car || share > 0.0) found = found || tried(slowed(share, car ? 1.0 : turn));
    }
  }
  if (!found) u = slowed(0.0, car ? 1.0 : 0.0);
  if (!found && car) {  // whichever way it is to leave, one of both steerings may be free: straight, or as wanted
    const auto& drive = std::get<AckerOptions>(world_.drive[object_]);
    const double psi = state_.extra[static_cast<std::size_t>(row_) * state_.extra_rows];
    if (std::fabs(psi) > kRounding) u[1] = drive.mode == Steering::steer ? 0.0 : -psi / world_.step_time;
  }
  work_.sides.clear();
  if (!found && car) hold_steering(u);
}

}  // namespace irsim
