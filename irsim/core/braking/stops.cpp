#include "braking/stops.hpp"

#include <algorithm>

#include "geometry/predicates.hpp"
#include "world/features.hpp"
#include "world/spec.hpp"
#include "world/state.hpp"
#include "world/world.hpp"

namespace irsim {
namespace {

constexpr int kMaxSteps = 40;  // longer ways are followed in larger steps

Vec3 within_limits(const World& world, const State& state, int row, int object, const Vec3& from, const Vec3& wanted,
                   double dt) {
  Vec3 next;
  for (int c = 0; c < 3; ++c) {
    const double change = state.acce[row][c] * dt;
    next[c] = clip(wanted[c], std::max(state.vel_min[row][c], from[c] - change),
                   std::min(state.vel_max[row][c], from[c] + change));
  }
  with(world.drive[object], [&](const auto& drive) { next = constrain(drive, next); });
  return next;
}

bool stands(const Drive& drive, const Vec3& control) {
  return control[0] == 0.0 && (steers(drive) || (control[1] == 0.0 && control[2] == 0.0));
}

/// Whether it has a behavior that stays on its side of borders, and a drive that can be predicted.
bool plans(const World& world, const State& state, int row, int object) {
  return brakes_in_time(world, object) && !state.stopped[row] && !state.given[row] && !state.waits(row) &&
         state.route_of(row) == nullptr && is_inert(world, state, row, object);
}

}  // namespace

Vec3 braking_control(const Drive& drive, double steering) {
  const std::optional<Car> car = car_of(drive);
  return car && car->mode == Steering::steer ? Vec3{{0.0, steering, 0.0}} : Vec3{};
}

bool brakes_in_time(const World& world, int object) {
  const Behavior& behavior = world.specs[object].behavior;
  return std::holds_alternative<OrcaOptions>(behavior) || std::holds_alternative<AvocadoOptions>(behavior) ||
         std::holds_alternative<RvoOptions>(behavior) || std::holds_alternative<SfmOptions>(behavior);
}

bool is_inert(const World& world, const State& state, int row, int object) {
  const Drive& drive = world.drive[object];
  if (std::holds_alternative<std::monostate>(drive)) return false;
  const Vec3& acce = state.acce[row];
  const bool omni = std::holds_alternative<OmniOptions>(drive) || std::holds_alternative<OmniAngularOptions>(drive);
  return std::isfinite(acce[0]) || (omni && std::isfinite(acce[1]));
}

void stop_after(const World& world, const State& state, int row, int object, const Vec3& wanted,
                std::vector<double>& extra, std::vector<Vec2>& centres) {
  centres.clear();
  const Drive& drive = world.drive[object];
  const Vec2 centre = state.scenes[row / world.objects].shapes->centre[object];
  Pose pose = state.pose[row];
  Vec3 twist, control = within_limits(world, state, row, object, state.control[row], wanted, world.step_time);
  const double* rows = &state.extra[static_cast<std::size_t>(row) * state.extra_rows];
  extra.assign(rows, rows + state.extra_rows);
  // A long stop is followed in larger steps, at the mean speed of the periods in each.
  double dt = world.step_time, early = 0.0;
  Vec3 mean = control;
  for (int k = 0; k < kMaxSteps; ++k) {
    with(drive, [&](const auto& options) {
      run(options, Motion{pose, extra.data(), twist, unit(pose.theta), mean, dt, world.integration});
    });
    centres.push_back(pose.position() + rotate(centre, unit(pose.theta)));
    if (k == 0) {
      double longest = 0.0;
      for (int c = 0; c < (steers(drive) ? 1 : 3); ++c) {
        if (state.acce[row][c] > 0.0) longest = std::max(longest, std::fabs(control[c]) / state.acce[row][c]);
      }
      dt = std::max(dt, longest / (kMaxSteps - 2));
      early = 0.5 * (1.0 - world.step_time / dt);
    }
    const Vec3 before = control;
    mean = control = within_limits(world, state, row, object, control, braking_control(drive, control[1]), dt);
    for (int c = 0; c < 3; ++c) mean[c] += early * (before[c] - control[c]);
    if (stands(drive, mean)) return;
  }
}

Stops& stops(const World& world, const State& state, Workspace& work, int w) {
  Stops& all = work.stops;
  if (all.known) return all;
  all.known = true;
  all.points.clear();
  all.of.resize(world.moving.size());
  const Shapes& shapes = *state.scenes[w].shapes;
  for (std::size_t m = 0; m < world.moving.size(); ++m) {
    const int i = world.moving[m], row = w * world.objects + i;
    const Vec2 here = state.pose[row].position() + rotate(shapes.centre[i], state.heading(row));
    Stop& stop = all.of[m];
    stop = {static_cast<int>(all.points.size()), 1, 0.0, shapes.radius[i], plans(world, state, row, i)};
    all.points.push_back(here);
    if (state.stopped[row] || state.waits(row)) continue;
    if (!stop.plans) {  // it may go on for a period as it does
      all.points.push_back(here + velocity_world(world, state, row, all.extra) * world.step_time);
      stop.count = 2;
      continue;
    }
    if (stands(world.drive[i], state.control[row])) continue;
    stop_after(world, state, row, i, braking_control(world.drive[i], state.control[row][1]), all.extra, all.trial);
    all.points.insert(all.points.end(), all.trial.begin(), all.trial.end());
    stop.count += static_cast<int>(all.trial.size());
    for (const Vec2 p : all.trial)
      stop.bulge = std::max(stop.bulge, norm(nearest_on_segment(here, all.trial.back(), p) - p));
  }
  return all;
}

}  // namespace irsim
