// Wheel odometry: the pose that the turns of two wheels add up to, as the robot believes its wheels to be. They turn as
// the body moves, and by what they slip.
//
// Systematic errors: Borenstein, Feng: Measurement and Correction of Systematic Odometry Errors in Mobile Robots (IEEE
// Trans. Robotics and Automation 12, 1996): unequal wheel diameters E_d and a wrong track E_b.
#pragma once

#include "fields.hpp"
#include "sensing/gauges.hpp"

namespace irsim {

struct OdometryOptions {
  double track;                                         // distance of the wheels as believed [m]
  double wheel_radius;                                  // as believed [m]
  int ticks_per_turn;                                   // of the encoders; 0: turns are exact
  double diameter_error;                                // true diameter of the right wheel over the left one, minus 1
  double track_error;                                   // true track over the believed one, minus 1
  double scale_error;                                   // true radii over the believed one, minus 1
  double diameter_std, track_std, scale_std;            // of what is added to these in each episode
  double distance_noise, heading_noise, turning_noise;  // see Drift
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using O = OdometryOptions;
    return visit(field("track", &O::track), field("wheel_radius", &O::wheel_radius),
                 field("ticks_per_turn", &O::ticks_per_turn), field("diameter_error", &O::diameter_error),
                 field("track_error", &O::track_error), field("scale_error", &O::scale_error),
                 field("diameter_std", &O::diameter_std), field("track_std", &O::track_std),
                 field("scale_std", &O::scale_std), field("distance_noise", &O::distance_noise),
                 field("heading_noise", &O::heading_noise), field("turning_noise", &O::turning_noise));
  }
};

inline std::vector<double> beams(const OdometryOptions&) { return {}; }
/// x, y, heading; speeds ahead, aside and yaw rate; ticks, or turns, of the left and the right wheel.
inline int readings(const OdometryOptions&) { return 8; }
/// The believed pose, the turns of both wheels, `Underfoot::unmoved`, and the believed speeds since the last reading.
inline int memory(const OdometryOptions&) { return kGaugeMemory + 8 + SinceReading::kNumbers; }

inline void odometry(const OdometryOptions& o, const Sensing& s) {
  Travel travel;
  const Due due = take_note(s, travel);
  if (due == Due::no) return;
  double *const pose = s.memory + kGaugeMemory, *const turns = pose + 3, *const unmoved = turns + 2;
  const SinceReading speeds{unmoved + 3};
  if (s.world.wheels_slip) {
    const Vec3 now = s.state.underfoot[s.w * s.world.objects + s.mount.object].unmoved;
    travel.ahead += now[0] - unmoved[0], travel.aside += now[1] - unmoved[1], travel.turn += now[2] - unmoved[2];
    for (int k = 0; k < 3; ++k) unmoved[k] = now[k];
  }
  if (due == Due::start) {
    pose[0] = s.pose.x, pose[1] = s.pose.y, pose[2] = s.pose.theta;
    turns[0] = turns[1] = 0.0;
    speeds.start();
    std::copy_n(pose, 3, s.readings);
    std::fill_n(s.readings + 3, 5, 0.0);
    return;
  }
  const auto episode = normals_of(s.draws(1), 0, {o.diameter_std, o.track_std, o.scale_std});
  const double factor = s.noise();
  const double unequal = 1.0 + o.diameter_error + factor * o.diameter_std * episode[0];
  const double track = o.track * (1.0 + o.track_error + factor * o.track_std * episode[1]);
  const double scale = 1.0 + o.scale_error + factor * o.scale_std * episode[2];
  const double radius[] = {2.0 * scale * o.wheel_radius / (1.0 + unequal),
                           2.0 * unequal * scale * o.wheel_radius / (1.0 + unequal)};
  double rolled[2];  // as believed [m]
  for (int side = 0; side < 2; ++side) {
    const double way = travel.ahead + (side == 0 ? -0.5 : 0.5) * track * travel.turn;
    const double before = turns[side], per_turn = kTurn * o.wheel_radius;
    turns[side] += way / (kTurn * radius[side]);
    const double ticks = o.ticks_per_turn;
    rolled[side] = ticks > 0 ? (std::floor(turns[side] * ticks) - std::floor(before * ticks)) * per_turn / ticks
                             : (turns[side] - before) * per_turn;
  }
  const auto draw = normals_of(s.draws(), s.scan_number(), {o.distance_noise, o.heading_noise, o.turning_noise});
  const Drift drift{factor * o.distance_noise, factor * o.heading_noise, factor * o.turning_noise};
  const Travel believed = drift.add(
      {0.5 * (rolled[0] + rolled[1]), scale * travel.aside, (rolled[1] - rolled[0]) / o.track}, draw[0], draw[1]);
  travel_on(pose, believed);
  const double dt = s.world.step_time;
  double speed[] = {believed.ahead / dt, believed.aside / dt, believed.turn / dt};
  speeds.add(speed, s.measures());
  if (!s.measures()) return;
  std::copy_n(pose, 3, s.readings);
  std::copy_n(speed, 3, s.readings + 3);
  for (int side = 0; side < 2; ++side) {
    s.readings[6 + side] = o.ticks_per_turn > 0 ? std::floor(turns[side] * o.ticks_per_turn) : turns[side];
  }
}

}  // namespace irsim
