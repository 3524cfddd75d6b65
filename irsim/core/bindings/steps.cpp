// The functions `advance` and `rollout`, and the phases of a step.
#include "bindings/bound_state.hpp"
#include "contact/push.hpp"
#include "phases.hpp"
#include "runs/batch.hpp"
#include "sensing.hpp"
#include "world/features.hpp"

namespace irsim {
namespace {

struct Trace {
  nb::object pose, control, goal, arrived, collided, stopped, steps, ranges, returns;
};

/// Join the recordings of all worlds to (T, W * size). A world that finished early keeps its last values.
template <class T, class Element>
nb::object join_worlds(const std::vector<Recording>& all, std::vector<Element> Recording::* part, const Element* now,
                       long long steps, std::size_t size, bool flat) {
  const std::size_t numbers = sizeof(Element) / sizeof(T), worlds = all.size();
  std::vector<T> out(static_cast<std::size_t>(steps) * worlds * size * numbers);
  for (std::size_t w = 0; w < worlds; ++w) {
    const std::vector<Element>& recorded = all[w].*part;
    for (long long t = 0; t < steps; ++t) {
      const Element* from = t < all[w].steps ? recorded.data() + t * size : now + w * size;
      if (size > 0) std::memcpy(&out[(t * worlds + w) * size * numbers], from, size * sizeof(Element));
    }
  }
  const std::size_t rows = worlds * size, count = static_cast<std::size_t>(steps);
  return flat ? own(std::move(out), {count, rows}) : own(std::move(out), {count, rows, numbers});
}

long long advance(World& world, BoundState& bound, long long steps, int threads, bool until_done, bool external) {
  State& state = bound.of(world);
  const Claim claim(bound);
  nb::gil_scoped_release free;
  return run_worlds(world, state, {steps, threads, until_done, external}, nullptr, {});
}

Trace rollout(World& world, BoundState& bound, long long steps, int threads, bool until_done, bool ranges,
              bool returns) {
  State& state = bound.of(world);
  const Claim claim(bound);
  std::vector<Recording> recordings(state.worlds);
  long long most = 0;
  {
    nb::gil_scoped_release free;
    most = run_worlds(world, state, {steps, threads, until_done, false}, &recordings, {ranges, returns});
  }
  const std::size_t n = world.objects;
  std::vector<std::int64_t> executed;
  for (const Recording& recording : recordings) executed.push_back(recording.steps);
  Trace out;
  const std::size_t beams = world.beams_per_world;
  std::vector<float> last;
  for (std::size_t b = 0; returns && b < state.ranges.size; ++b) last.push_back(returned_range(state, b));
  out.pose = join_worlds<double>(recordings, &Recording::pose, state.pose.data, most, n, false);
  out.control = join_worlds<double>(recordings, &Recording::control, state.control.data, most, n, false);
  out.goal = join_worlds<double>(recordings, &Recording::goal, state.goal.data, most, n, false);
  out.arrived = join_worlds<std::uint8_t>(recordings, &Recording::arrived, state.arrived.data, most, n, true);
  out.collided = join_worlds<std::uint8_t>(recordings, &Recording::collided, state.collided.data, most, n, true);
  out.stopped = join_worlds<std::uint8_t>(recordings, &Recording::stopped, state.stopped.data, most, n, true);
  out.ranges = join_worlds<double>(recordings, &Recording::ranges, state.ranges.data, ranges ? most : 0, beams, true);
  out.returns = join_worlds<float>(recordings, &Recording::returns, last.data(), returns ? most : 0, beams, true);
  const std::size_t worlds = executed.size();
  out.steps = own(std::move(executed), {worlds});
  return out;
}

/// A phase that runs for every world.
template <class Phase>
auto all_worlds(Phase phase) {
  return [phase](World& world, BoundState& bound) {
    State& state = bound.of(world);
    const Claim claim(bound);
    nb::gil_scoped_release free;
    for (int w = 0; w < state.worlds; ++w) phase(world, state, w, state.workspaces.front());
  };
}

using Point = std::pair<double, double>;

std::vector<std::tuple<int, double, double, double, double, double>> near_objects(World& world, BoundState& bound,
                                                                                  int w, Point centre, double reach) {
  State& state = bound.of(world);
  bound.check_world(w);
  Workspace& work = state.workspaces.front();
  work.neighbors.known = false;
  std::vector<std::tuple<int, double, double, double, double, double>> out;
  for_neighbors(world, state, work, w, {centre.first, centre.second}, reach, [&](int id) {
    const Disc disc = disc_of(world, state, work, w, id);
    out.emplace_back(id, disc.centre.x, disc.centre.y, disc.velocity.x, disc.velocity.y, disc.radius);
  });
  return out;
}

std::vector<std::tuple<double, double, double, double, int, int, int>> near_walls(World& world, BoundState& bound,
                                                                                  int w, Point centre, double reach) {
  State& state = bound.of(world);
  bound.check_world(w);
  const Fixed& fixed = *state.scenes[w].fixed;
  std::vector<int> found;
  std::vector<std::tuple<double, double, double, double, int, int, int>> out;
  for_walls(fixed.walls, found, {centre.first, centre.second}, reach, [&](const Wall& wall) {
    out.emplace_back(wall.a.x, wall.a.y, wall.b.x, wall.b.y, wall.object, wall.next, wall.previous);
  });
  return out;
}

}  // namespace

void bind_steps(nb::module_& m) {
  nb::class_<Trace>(m, "Trace")
      .def_ro("pose", &Trace::pose)
      .def_ro("control", &Trace::control)
      .def_ro("goal", &Trace::goal)
      .def_ro("arrived", &Trace::arrived)
      .def_ro("collided", &Trace::collided)
      .def_ro("stopped", &Trace::stopped)
      .def_ro("steps", &Trace::steps)
      .def_ro("ranges", &Trace::ranges)
      .def_ro("returns", &Trace::returns);
  m.def("advance", &advance, nb::arg("world"), nb::arg("state"), nb::arg("steps"), nb::kw_only(),
        nb::arg("threads") = 1, nb::arg("until_done") = false, nb::arg("external") = false);
  m.def("rollout", &rollout, nb::arg("world"), nb::arg("state"), nb::arg("steps"), nb::kw_only(),
        nb::arg("threads") = 1, nb::arg("until_done") = false, nb::arg("ranges") = false, nb::arg("returns") = false);
  using W = const World&;
  const auto phase = [&](const char* name, auto call) {
    m.def(name, all_worlds(call), nb::arg("world"), nb::arg("state"));
  };
  phase("decide", [](W world, State& s, int w, Workspace& work) { decide(world, s, w, work); });
  phase("limit", [](W world, State& s, int w, Workspace&) { limit(world, s, w); });
  phase("integrate", [](W world, State& s, int w, Workspace&) { integrate(world, s, w); });
  phase("push_apart", [](W world, State& s, int w, Workspace& work) { push_apart(world, s, w, work); });
  phase("finish", [](W world, State& s, int w, Workspace&) { finish(world, s, w); });
  phase("collide", [](W world, State& s, int w, Workspace&) { collide(world, s, w); });
  phase("arrive", [](W world, State& s, int w, Workspace&) { arrive(world, s, w); });
  phase("sense", [](W world, State& s, int w, Workspace& work) { sense(world, s, w, work); });
  phase("watch", [](W world, State& s, int w, Workspace& work) { watch(world, s, w, work); });
  m.def(
      "scan",
      [](World& world, BoundState& bound, int w, int sensor, std::array<double, 3> pose) {
        State& state = bound.of(world);
        bound.check_world(w);
        if (sensor < 0 || sensor >= static_cast<int>(world.scans.size())) throw nb::index_error("no such sensor");
        Workspace& work = state.workspaces.front();
        place_moving(world, state, w);
        update_object_velocities(world, state, w, work);
        scan(world, state, w, sensor, {pose[0], pose[1], pose[2]}, unit(pose[2]), work);
      },
      nb::arg("world"), nb::arg("state"), nb::arg("index"), nb::arg("sensor"), nb::arg("pose"));
  m.def(
      "follow",
      [](World& world, BoundState& bound, int row, std::pair<double, double> velocity) {
        State& state = bound.of(world);
        bound.check_row(row);
        const Vec3 u =
            control_for(world, state, row / world.objects, row % world.objects, {velocity.first, velocity.second}, {});
        return std::make_tuple(u[0], u[1], u[2]);
      },
      nb::arg("world"), nb::arg("state"), nb::arg("row"), nb::arg("velocity"));
  m.def(
      "shift",
      [](World& world, BoundState& bound, int row, Point by, double turn) {
        State& state = bound.of(world);
        bound.check_row(row);
        const Vec2 centroid = bodies_of(world, state, row / world.objects).centroid[row % world.objects];
        shift(world, state, row, {by.first, by.second}, turn, centroid);
        const double per_second = 1.0 / world.step_time;
        push(world, state, row, Vec2{by.first, by.second} * per_second, turn * per_second);
      },
      nb::arg("world"), nb::arg("state"), nb::arg("row"), nb::arg("by"), nb::arg("turn"));
  m.def(
      "push",
      [](World& world, BoundState& bound, int row, Point change) {
        State& state = bound.of(world);
        bound.check_row(row);
        push(world, state, row, {change.first, change.second}, 0.0);
      },
      nb::arg("world"), nb::arg("state"), nb::arg("row"), nb::arg("change"));
  m.def(
      "contact_step",
      [](World& world, BoundState& bound, int w, const std::vector<std::pair<int, int>>& pairs, int sweeps, double slop,
         double step_time) {
        State& state = bound.of(world);
        bound.check_world(w);
        push_apart(world, state, w, state.workspaces.front(), {sweeps, 0, slop, step_time}, &pairs);
      },
      nb::arg("world"), nb::arg("state"), nb::arg("index"), nb::arg("pairs"), nb::arg("sweeps"), nb::arg("slop"),
      nb::arg("step_time"));
  m.def("neighbors", &near_objects, nb::arg("world"), nb::arg("state"), nb::arg("index"), nb::arg("centre"),
        nb::arg("reach"));
  m.def("walls", &near_walls, nb::arg("world"), nb::arg("state"), nb::arg("index"), nb::arg("centre"),
        nb::arg("reach"));
}

}  // namespace irsim
