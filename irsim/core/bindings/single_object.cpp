// The phases of a step for a single object, and drives without a world.
#include <algorithm>

#include "bindings/bound_state.hpp"
#include "phases.hpp"
#include "world/features.hpp"
#include "world/spec.hpp"

namespace irsim {
namespace {

using Numbers = std::vector<double>;

/// The pose and extra rows that a drive needs where no world holds them.
struct LoneObject {
  Pose pose;
  Numbers extra;
  Vec2 direction;

  LoneObject(const Drive& drive, const Numbers& state) {
    if (state.size() < 3) throw nb::value_error("a state must have at least three numbers");
    pose = {state[0], state[1], state[2]};
    extra.assign(state.begin() + 3, state.end());
    std::size_t inner = 1;
    with(drive, [&](const auto& options) { inner = std::max<std::size_t>(inner, rows(options).inner); });
    extra.resize(std::max(extra.size(), inner));
    direction = unit(pose.theta);
  }
};

Vec3 control_of(const Numbers& values) {
  Vec3 out;
  for (std::size_t c = 0; c < 3 && c < values.size(); ++c) out[static_cast<int>(c)] = values[c];
  return out;
}

std::pair<Numbers, Numbers> drive_step(const Drive& drive, const Numbers& state, const Numbers& control, double dt,
                                       int integration) {
  LoneObject object(drive, state);
  Vec3 twist;
  with(drive, [&](const auto& options) {
    run(options, Motion{object.pose, object.extra.data(), twist, object.direction, control_of(control), dt,
                        static_cast<Integration>(integration)});
  });
  Numbers out{object.pose.x, object.pose.y, object.pose.theta};
  out.insert(out.end(), object.extra.begin(), object.extra.begin() + static_cast<std::ptrdiff_t>(state.size() - 3));
  return {out, {twist[0], twist[1], twist[2]}};
}

Numbers rates_of_single_track(const Drive& drive, const std::array<double, 5>& state, double rate,
                              double acceleration) {
  const auto* options = std::get_if<SingleTrackOptions>(&drive);
  if (options == nullptr) throw nb::value_error("the drive must be a single track");
  const double values[5] = {state[0], state[1], state[2], state[3], state[4]};
  return single_track_rates(*options, values, rate, acceleration);
}

Numbers drive_follow(const Drive& drive, const Numbers& state, const Numbers& velocity, double min_speed,
                     double tolerance, double guarantee_time, double max_rate, double acce, double dt) {
  const LoneObject object(drive, state);
  if (velocity.size() != 2) throw nb::value_error("a velocity must have two numbers");
  const Turning turning{min_speed, tolerance, guarantee_time, max_rate, kInfinity, acce, dt};
  Vec3 control;
  with(drive, [&](const auto& options) {
    control =
        follow(options, Wish{{velocity[0], velocity[1]}, object.pose, object.extra.data(), object.direction, turning});
  });
  return {control[0], control[1], control[2]};
}

Numbers drive_deviation(const Drive& drive, const Numbers& control) {
  Vec3 sigma;
  with(drive, [&](const auto& options) { sigma = deviation(options, control_of(control)); });
  return {sigma[0], sigma[1], sigma[2]};
}

/// Impose a control on a row for the next step, and return whether limits of speed or acceleration will cut it.
/// Refusals of the drive itself do not count, nor does an excess below `kRounding`, which is a rounding error.
bool impose_row(const World& world, BoundState& bound, int row, const Numbers& control) {
  constexpr double kRounding = 1e-9;
  State& state = bound.of(world);
  bound.check_row(row);
  const bool actuated = world.has_actuators[row % world.objects];
  const Vec3 &now = actuated ? state.actuated[row].setpoint : state.control[row], &acce = state.acce[row];
  bool cut = false;
  for (int c = 0; c < 3 && c < static_cast<int>(control.size()); ++c) {
    const double wanted = control[static_cast<std::size_t>(c)], change = acce[c] * world.step_time;
    state.command[row][c] = wanted;
    cut |= wanted < std::max(state.vel_min[row][c], now[c] - change) - kRounding ||
           wanted > std::min(state.vel_max[row][c], now[c] + change) + kRounding;
  }
  state.given[row] = 1;
  return cut;
}

/// Bind a phase of a single row.
template <class Phase>
void bind_phase(nb::module_& m, const char* name, Phase phase) {
  m.def(
      name,
      [phase](World& world, BoundState& bound, int row) {
        State& state = bound.of(world);
        bound.check_row(row);
        phase(world, state, row / world.objects, row % world.objects);
      },
      nb::arg("world"), nb::arg("state"), nb::arg("row"));
}

}  // namespace

void bind_object(nb::module_& m) {
  using W = const World&;
  bind_phase(m, "renew_row", [](W world, State& s, int w, int i) { renew_goals(world, s, w, i); });
  bind_phase(m, "decide_row", [](W world, State& s, int w, int i) { decide(world, s, w, s.workspaces.front(), i); });
  m.def("impose_row", &impose_row, nb::arg("world"), nb::arg("state"), nb::arg("row"), nb::arg("control"));
  bind_phase(m, "limit_row", [](W world, State& s, int w, int i) { limit(world, s, w, i); });
  bind_phase(m, "integrate_row", [](W world, State& s, int w, int i) { integrate(world, s, w, i); });
  bind_phase(m, "remember_row", [](W world, State& s, int w, int i) { remember(s, w * world.objects + i); });
  const Turning defaults;
  m.def("single_track_rates", &rates_of_single_track, nb::arg("drive"), nb::arg("state"), nb::arg("rate"),
        nb::arg("acceleration"));
  m.def("drive_step", &drive_step, nb::arg("drive"), nb::arg("state"), nb::arg("control"), nb::arg("dt"),
        nb::arg("integration") = static_cast<int>(kEuler));
  m.def("drive_follow", &drive_follow, nb::arg("drive"), nb::arg("state"), nb::arg("velocity"),
        nb::arg("min_speed") = defaults.min_speed, nb::arg("tolerance") = defaults.tolerance,
        nb::arg("guarantee_time") = defaults.guarantee_time, nb::arg("max_rate") = defaults.max_rate,
        nb::arg("acce") = defaults.acce, nb::arg("dt") = defaults.dt);
  m.def("drive_deviation", &drive_deviation, nb::arg("drive"), nb::arg("control"));
}

}  // namespace irsim
