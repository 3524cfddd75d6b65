// dash: drive straight to the goal without avoiding others. Each drive has its own law; drives without
// one get the wanted velocity.
#pragma once

#include "decision.hpp"
#include "fields.hpp"

namespace irsim {

struct DashOptions {
  double angle_tolerance;  // heading errors smaller than this are not corrected [rad]
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("angle_tolerance", &DashOptions::angle_tolerance));
  }
};

/// The facts about one object that the laws need.
struct Dasher {
  double distance, bearing;  // of the goal: [m], [rad] in the world frame
  double theta;              // heading of the object [rad]
  double goal_theta;         // heading of the goal [rad], NaN without one
  double threshold;          // goal_threshold [m]
  Vec3 top;                  // vel_max
  Vec3 acce;
  double dt;
  double tolerance;

  double error() const { return wrap(bearing - theta); }
};

/// Largest turn rate from which the object can stop within the heading error. `axis` is the index of the turning
/// control.
inline double turn_ramp(const Dasher& d, double error, int axis) {
  const double sign = error > 0.0 ? 1.0 : error < 0.0 ? -1.0 : 0.0;
  const double limit = std::fabs(d.top[axis]), acce = d.acce[axis];
  if (!std::isfinite(acce) || acce <= 0.0) return sign * limit;
  const double change = acce * d.dt;
  return sign * std::min(limit, -change + std::sqrt(change * change + 2.0 * acce * (std::fabs(error) - d.tolerance)));
}

inline Intent dash_law(const DiffOptions&, const Dasher& d) {
  if (d.distance < d.threshold) return Intent::of_control({});
  const double error = d.error();
  const double yaw = std::fabs(error) < d.tolerance ? 0.0 : turn_ramp(d, error, 1);
  return Intent::of_control({{d.top[0] * std::cos(error), yaw, 0.0}});
}

inline Intent dash_law(const OmniOptions&, const Dasher& d) {
  if (!(d.distance > d.threshold)) return Intent::of_control({});
  const double error = d.error();
  return Intent::of_control({{d.top[0] * std::cos(error), d.top[1] * std::sin(error), 0.0}});
}

inline Intent dash_law(const OmniAngularOptions&, const Dasher& d) {
  Vec3 u;
  double target = d.bearing;
  if (d.distance > d.threshold) {
    const double error = d.error();
    u[0] = d.top[0] * std::cos(error), u[1] = d.top[1] * std::sin(error);
  } else {
    target = std::isnan(d.goal_theta) ? d.theta : d.goal_theta;
  }
  const double turn = wrap(target - d.theta);
  if (std::fabs(turn) > d.tolerance) u[2] = turn_ramp(d, turn, 2);
  return Intent::of_control(u);
}

inline Intent dash_law(const AckerOptions&, const Dasher& d) {
  if (d.distance < d.threshold) return Intent::of_control({});
  double error = d.error();
  if (std::fabs(error) < d.tolerance) error = 0.0;
  return Intent::of_control({{d.top[0], clip(error, -d.top[1], d.top[1]), 0.0}});
}

template <class OtherDrive>
Intent dash_law(const OtherDrive&, const Dasher& d) {
  return Intent::of_velocity(d.distance > d.threshold ? unit(d.bearing) * d.top[0] : Vec2{});
}

inline void dash(const DashOptions& options, const Decision& decision, Intent* intents) {
  const World& world = decision.world;
  for (int k = 0; k < decision.count; ++k) {
    const int i = decision.objects[k], row = decision.row(k);
    const Goal& goal = decision.state.destination(row);
    if (std::isnan(goal.x)) {
      intents[k] = Intent::of_control({});
      continue;
    }
    const Pose& pose = decision.state.pose[row];
    const Vec2 way = goal.position() - pose.position();
    const Dasher dasher{norm(way),
                        std::atan2(way.y, way.x),
                        pose.theta,
                        goal.theta,
                        world.goal_threshold[i],
                        decision.state.vel_max[row],
                        decision.state.acce[row],
                        world.step_time,
                        options.angle_tolerance};
    intents[k] = std::visit([&](const auto& drive) { return dash_law(drive, dasher); }, world.drive[i]);
  }
}

}  // namespace irsim
