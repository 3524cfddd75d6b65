// The class `State`: its arrays, resets and what is read of rows and worlds.
#include <algorithm>

#include "bindings/bound_state.hpp"
#include "phases.hpp"
#include "sensing/view.hpp"
#include "world/exchange.hpp"
#include "world/snapshot.hpp"
#include "world/spec.hpp"

namespace irsim {
namespace {

std::vector<Goal> to_goals(const std::vector<std::vector<double>>& lists) {
  std::vector<Goal> out;
  for (const auto& g : lists) {
    if (g.size() < 2) throw nb::value_error("a goal must have two or three numbers");
    out.push_back({g[0], g[1], g.size() > 2 ? g[2] : kNone});
  }
  return out;
}

nb::object goals_of(const BoundState& self, int row) {
  self.check_row(row);
  const GoalQueue& queue = self.state.goals[row];
  nb::list out;
  for (std::size_t k = queue.head; k < queue.goals.size(); ++k) {
    const Goal& g = queue.goals[k];
    std::vector<double> numbers = {g.x, g.y};
    if (!std::isnan(g.theta)) numbers.push_back(g.theta);
    out.append(nb::cast(numbers));
  }
  return out;
}

nb::object opinions_of(const BoundState& self, int row) {
  self.check_row(row);
  nb::list out;
  if (self.state.opinions.empty()) return out;
  for (const Opinion& o : self.state.opinions[row].of) out.append(nb::make_tuple(o.about, o.opinion, o.attention));
  return out;
}

void set_goals(BoundState& self, int row, const std::vector<std::vector<double>>& lists, bool init) {
  self.check_row(row);
  GoalQueue& queue = self.state.goals[row];
  queue.set(to_goals(lists));
  if (init) queue.initial = queue.goals;
  self.state.sync_goal(row);
}

void set_initial(BoundState& self, int row, bool pose, bool control) {
  self.check_row(row);
  State& s = self.state;
  if (control) s.initial_control[row] = s.control[row];
  if (!pose) return;
  s.initial_pose[row] = s.pose[row];
  const std::size_t e = static_cast<std::size_t>(row) * s.extra_rows;
  std::copy_n(&s.extra[e], s.extra_rows, &s.initial_extra[e]);
}

nb::object initial_state(const BoundState& self, int row) {
  self.check_row(row);
  const State& s = self.state;
  const Pose& pose = s.initial_pose[row];
  std::vector<double> out = {pose.x, pose.y, pose.theta};
  const double* extra = &s.initial_extra[static_cast<std::size_t>(row) * s.extra_rows];
  out.insert(out.end(), extra, extra + s.extra_rows);
  const std::size_t size = out.size();
  return own(std::move(out), {size});
}

const std::vector<double>& history_of(const BoundState& self, int row) {
  self.check_row(row);
  if (!self.state.keep_history) throw nb::value_error("this state does not keep a history");
  return self.state.history[row];
}

std::size_t recorded(const BoundState& self, int row) {
  return history_of(self, row).size() / (3 + static_cast<std::size_t>(self.state.extra_rows));
}

nb::object trajectory(const BoundState& self, int row, std::size_t first) {
  const std::vector<double>& track = history_of(self, row);
  const std::size_t columns = 3 + static_cast<std::size_t>(self.state.extra_rows);
  const std::size_t count = recorded(self, row);
  const std::size_t start = std::min(first, count);
  std::vector<double> states(track.begin() + static_cast<std::ptrdiff_t>(start * columns), track.end());
  return own(std::move(states), {count - start, columns});
}

nb::object standings(const BoundState& self, int row) {
  self.check_row(row);
  if (!self.state.keep_history) throw nb::value_error("this state does not keep a history");
  std::vector<std::int64_t> steps;
  std::vector<double> goals;
  std::vector<std::uint8_t> stopped;
  for (const Standing& s : self.state.standings[row]) {
    steps.push_back(s.step);
    goals.insert(goals.end(), {s.goal.x, s.goal.y, s.goal.theta});
    stopped.push_back(s.stopped);
  }
  const std::size_t count = steps.size();
  return nb::make_tuple(own(std::move(steps), {count}), own(std::move(goals), {count, 3}),
                        own(std::move(stopped), {count}));
}

std::tuple<double, double> velocity_of(const BoundState& self, int row) {
  self.check_row(row);
  const Vec2 v = velocity_world(*self.world, self.state, row);
  return {v.x, v.y};
}

nb::object velocities_of(const BoundState& self, int w) {
  self.check_world(w);
  const int n = self.world->objects;
  std::vector<double> out, scratch;
  for (int i = 0; i < n; ++i) {
    const Vec2 v = velocity_world(*self.world, self.state, w * n + i, scratch);
    out.insert(out.end(), {v.x, v.y});
  }
  return own(std::move(out), {static_cast<std::size_t>(n), 2});
}

std::tuple<double, double> drive_velocity_of(const BoundState& self, int row) {
  self.check_row(row);
  std::vector<double> scratch;
  const Vec2 v = velocity_of_control(*self.world, self.state, row, self.state.drive[row], scratch);
  return {v.x, v.y};
}

nb::object events(const BoundState& self, int w, std::size_t start) {
  self.check_world(w);
  nb::list out;
  const std::vector<Event>& all = self.state.scenes[w].events;
  for (std::size_t k = start; k < all.size(); ++k) {
    const Event& e = all[k];
    out.append(nb::make_tuple(kEventNames[static_cast<int>(e.kind)], e.step, e.object, e.partner, e.x, e.y));
  }
  return out;
}

nb::object moments(const BoundState& self, int w, std::size_t start) {
  self.check_world(w);
  nb::list out;
  const std::vector<Event>& all = self.state.scenes[w].events;
  for (std::size_t k = start; k < all.size(); ++k) out.append(nb::make_tuple(all[k].when, all[k].depth));
  return out;
}

nb::object collision_pairs(const BoundState& self, int w) {
  self.check_world(w);
  std::vector<std::int32_t> out;
  for (const auto& [i, j] : self.state.scenes[w].pairs) {
    out.push_back(i);
    out.push_back(j);
  }
  const std::size_t count = out.size() / 2;
  return own(std::move(out), {count, 2});
}

nb::object contacts(const BoundState& self, int w) {
  self.check_world(w);
  nb::list out;
  for (const Contact& c : self.state.scenes[w].contacts) {
    out.append(nb::make_tuple(c.a, c.b, c.normal.x, c.normal.y, c.depth, c.point.x, c.point.y, c.force));
  }
  return out;
}

}  // namespace

void bind_state(nb::module_& m) {
  using S = BoundState;
  nb::class_<S> state(m, "State");
  state
      .def(nb::init<World&, const Seeds&, bool>(), nb::arg("world"), nb::arg("seeds"), nb::arg("history"),
           nb::keep_alive<1, 2>())
      .def(nb::init<World&, const S&, const std::vector<std::pair<S*, int>>&>(), nb::arg("world"), nb::arg("before"),
           nb::arg("origins"), nb::keep_alive<1, 2>())
      .def_ro("pose", &S::pose)
      .def_ro("extra", &S::extra)
      .def_ro("control", &S::control)
      .def_ro("twist", &S::twist)
      .def_ro("command", &S::command)
      .def_ro("commanded", &S::commanded)
      .def_ro("drive", &S::drive)
      .def_ro("actuated", &S::actuated)
      .def_ro("contact_time", &S::contact_time)
      .def_ro("air_time", &S::air_time)
      .def_ro("touching", &S::touching)
      .def_ro("given", &S::given)
      .def_ro("arrived", &S::arrived)
      .def_ro("believes_arrived", &S::believes_arrived)
      .def_ro("collided", &S::collided)
      .def_ro("stopped", &S::stopped)
      .def_ro("radius", &S::radius)
      .def_ro("vel_min", &S::vel_min)
      .def_ro("vel_max", &S::vel_max)
      .def_ro("acce", &S::acce)
      .def_ro("takes_part", &S::takes_part)
      .def_ro("size_scale", &S::size_scale)
      .def_ro("speed_scale", &S::speed_scale)
      .def_ro("acceleration_scale", &S::acceleration_scale)
      .def_ro("noise_scale", &S::noise_scale)
      .def_ro("delay_scale", &S::delay_scale)
      .def_ro("lag_scale", &S::lag_scale)
      .def_ro("sensor_rate_scale", &S::sensor_rate_scale)
      .def_ro("sensor_latency_scale", &S::sensor_latency_scale)
      .def_ro("slip_scale", &S::slip_scale)
      .def_ro("grip_scale", &S::grip_scale)
      .def_ro("latency", &S::latency)
      .def_ro("level", &S::level)
      .def_ro("variant", &S::variant)
      .def_ro("pace", &S::pace)
      .def_ro("start_step", &S::start_step)
      .def_ro("appeared", &S::appeared)
      .def_ro("infeasible", &S::infeasible)
      .def_ro("between_steps", &S::between_steps)
      .def_ro("goal", &S::goal)
      .def_ro("ranges", &S::ranges)
      .def_ro("hits", &S::hits)
      .def_ro("valid", &S::valid)
      .def_ro("beam_angles", &S::beam_angles)
      .def_ro("velocities", &S::velocities)
      .def_ro("readings", &S::readings)
      .def_ro("stamp", &S::stamp)
      .def_ro("explored", &S::explored)
      .def_ro("count", &S::count)
      .def_ro("scene", &S::scene)
      .def_ro("noise", &S::noise)
      .def_ro("seed", &S::seed)
      .def_ro("failed_placement", &S::failed_placement)
      .def_prop_ro("event_count",
                   [](const S& self) {
                     std::int64_t sum = 0;
                     for (const std::int64_t n : self.state.event_count) sum += n;
                     return sum;
                   })
      .def(
          "reset",
          [](S& self, const Mask& mask, bool next_scene, int threads) {
            self.check_mask(mask);
            const Claim claim(self);
            nb::gil_scoped_release free;
            reset(*self.world, self.state, mask.data(), next_scene, threads);
          },
          nb::arg("mask"), nb::arg("next_scene"), nb::arg("threads") = 1)
      .def(
          "reseed",
          [](S& self, const Seeds& seeds, const Mask& mask) {
            self.check_mask(mask);
            self.check_idle();
            if (static_cast<int>(seeds.shape(0)) != self.state.worlds)
              throw nb::value_error("one seed per world is needed");
            reseed(self.state, seeds.data(), mask.data());
          },
          nb::arg("seeds"), nb::arg("mask"))
      .def("save",
           [](S& self) {
             self.check_idle();
             const std::vector<char> bytes = save(self.state);
             return nb::bytes(bytes.data(), bytes.size());
           })
      .def(
          "load",
          [](S& self, const nb::bytes& bytes) {
            const Claim claim(self);
            load(*self.world, self.state, bytes.c_str(), bytes.size());
          },
          nb::arg("bytes"))
      .def("refresh",
           [](S& self) {
             const Claim claim(self);
             refresh(*self.world, self.state);
           })
      .def("all_done",
           [](const S& self) {
             self.check_idle();
             std::vector<std::uint8_t> flags;
             for (int w = 0; w < self.state.worlds; ++w) flags.push_back(done(*self.world, self.state, w));
             return own(std::move(flags), {static_cast<std::size_t>(self.state.worlds)});
           })
      .def(
          "done",
          [](const S& self, int w) {
            self.check_world(w);
            return done(*self.world, self.state, w);
          },
          nb::arg("world"))
      .def("events", &events, nb::arg("world"), nb::arg("start") = 0)
      .def("moments", &moments, nb::arg("world"), nb::arg("start") = 0)
      .def("collision_pairs", &collision_pairs, nb::arg("world"))
      .def("contacts", &contacts, nb::arg("world"))
      .def("goals", &goals_of, nb::arg("row"))
      .def("set_goals", &set_goals, nb::arg("row"), nb::arg("goals"), nb::arg("init"))
      .def("set_initial", &set_initial, nb::arg("row"), nb::arg("pose"), nb::arg("control"))
      .def(
          "route",
          [](const S& self, int row) -> nb::object {
            self.check_row(row);
            if (self.state.routes.empty() || self.state.routes[row].path.empty()) return nb::none();
            const std::vector<Vec2>& path = self.state.routes[row].path;
            std::vector<double> out;
            for (const Vec2& p : path) out.insert(out.end(), {p.x, p.y});
            return own(std::move(out), {path.size(), 2});
          },
          nb::arg("row"))
      .def(
          "rest",
          [](S& self, int row) {
            self.check_row(row);
            if (self.world->has_actuators[row % self.world->objects])
              rest_at(*self.world, self.state, row, self.state.control[row]);
          },
          nb::arg("row"))
      .def("opinions", &opinions_of, nb::arg("row"))
      .def("initial_state", &initial_state, nb::arg("row"))
      .def("velocity_world", &velocity_of, nb::arg("row"))
      .def("velocities_world", &velocities_of, nb::arg("world"))
      .def("drive_velocity_world", &drive_velocity_of, nb::arg("row"))
      .def(
          "moved",
          [](S& self, int row) {
            self.check_row(row);
            pose_changed(*self.world, self.state, row);
          },
          nb::arg("row"))
      .def(
          "in_view",
          [](S& self, int row, double angle, double reach, bool occlusion) {
            self.check_row(row);
            const int n = self.world->objects;
            return in_view(*self.world, self.state, row / n, {row % n, angle, reach, occlusion},
                           self.state.workspaces.front());
          },
          nb::arg("row"), nb::arg("angle"), nb::arg("reach"), nb::arg("occlusion"))
      .def(
          "reset_row",
          [](S& self, int row) {
            self.check_row(row);
            restart_row(*self.world, self.state, row);
            pose_changed(*self.world, self.state, row);
          },
          nb::arg("row"))
      .def(
          "reshape",
          [](S& self, int row, const std::vector<PartSpec>& parts, std::uint64_t seed) {
            self.check_row(row);
            if (parts.empty()) throw nb::value_error("an object needs at least one part");
            reshape(*self.world, self.state, row, draw_outlines(parts, Draws({seed, 0}, Stream::shape, 0)));
          },
          nb::arg("row"), nb::arg("parts"), nb::arg("seed"))
      .def("look",
           [](S& self) {
             const Claim claim(self);
             for (int w = 0; w < self.state.worlds; ++w) {
               place_fixed(*self.world, self.state, w);
               place_moving(*self.world, self.state, w);
               sense(*self.world, self.state, w, self.state.workspaces.front());
             }
           })
      .def("recorded", &recorded, nb::arg("row"))
      .def("trajectory", &trajectory, nb::arg("row"), nb::arg("first") = 0)
      .def("standings", &standings, nb::arg("row"));
  bind_row_geometry(state);
}

}  // namespace irsim
