#include "bindings/bound_state.hpp"

#include "phases.hpp"
#include "sensing/view.hpp"
#include "world/exchange.hpp"
#include "world/spec.hpp"

namespace irsim {
namespace {

State make_state(const World& world, const Seeds& seeds, bool history) {
  if (static_cast<int>(seeds.shape(0)) != world.copies) throw nb::value_error("one seed per world is needed");
  return State(world, seeds.data(), history);
}

std::vector<Goal> to_goals(const std::vector<std::vector<double>>& lists) {
  std::vector<Goal> out;
  for (const auto& g : lists) {
    if (g.size() < 2) throw nb::value_error("a goal needs two or three numbers");
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

/// Others whose bounding boxes meet that of a row, where everything is now.
std::vector<int> near_row(BoundState& self, int row) {
  self.check_row(row);
  const World& world = *self.world;
  const int w = row / world.objects, object = row % world.objects;
  place_fixed(world, self.state, w);
  place_moving(world, self.state, w);
  const Box box = self.state.footprint(world, w, object).box;
  std::vector<int> found;
  for (int i = 0; i < world.objects; ++i) {
    if (i != object && self.state.footprint(world, w, i).box.meets(box)) found.push_back(i);
  }
  return found;
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

nb::object body(BoundState& self, int row) {
  self.check_row(row);
  const int object = row % self.world->objects;
  const Bodies& bodies = bodies_of(*self.world, self.state, row / self.world->objects);
  const Vec2 centroid = bodies.centroid[object];
  return nb::make_tuple(bodies.inverse_mass[object], bodies.inverse_inertia[object], bodies.gyration2[object],
                        centroid.x, centroid.y);
}

nb::object pieces(BoundState& self, int row) {
  self.check_row(row);
  const int object = row % self.world->objects;
  const Bodies& bodies = bodies_of(*self.world, self.state, row / self.world->objects);
  nb::list out;
  for (int p = bodies.begin[object]; p < bodies.begin[object + 1]; ++p) {
    std::vector<double> numbers;
    const Convex& piece = bodies.pieces[p];
    for (int v = piece.first; v < piece.first + piece.count; ++v) {
      numbers.insert(numbers.end(), {bodies.vertices[v].x, bodies.vertices[v].y});
    }
    out.append(own(std::move(numbers), {static_cast<std::size_t>(piece.count), 2}));
  }
  return out;
}

nb::object trajectory(const BoundState& self, int row) {
  self.check_row(row);
  if (!self.state.keep_history) throw nb::value_error("this state keeps no history");
  const std::vector<double>& track = self.state.history[row];
  const std::size_t columns = 3 + static_cast<std::size_t>(self.state.extra_rows);
  return own(track, {track.size() / columns, columns});
}

/// A part in the body frame, or at the present pose of the row.
struct PlacedPart {
  Part part;
  std::vector<Vec2> vertices;
};
PlacedPart part_of(const BoundState& self, int row, int part, bool world_frame) {
  self.check_row(row);
  const int object = row % self.world->objects;
  const Shapes& shapes = *self.state.scenes[row / self.world->objects].shapes;
  if (part < 0 || part >= shapes.part_count(object)) throw nb::index_error("no such part");
  const Slot& slot = shapes.body[object];
  PlacedPart out{shapes.parts[slot.part + part], {}};
  for (int v = out.part.first; v <= out.part.last; ++v) {
    const Vec2 body = shapes.vertices[slot.vertex + v];
    const Pose& pose = self.state.pose[row];
    out.vertices.push_back(
        world_frame && !shapes.is_map(object) ? pose.position() + rotate(body, self.state.heading(row)) : body);
  }
  return out;
}

nb::object vertices(const BoundState& self, int row, int part, bool world_frame) {
  const PlacedPart placed = part_of(self, row, part, world_frame);
  const bool ring = is_closed(placed.part.kind);
  const std::size_t count = placed.part.kind == Kind::circle ? 0 : placed.vertices.size() - (ring ? 1 : 0);
  std::vector<double> out;
  for (std::size_t v = 0; v < count; ++v) out.insert(out.end(), {placed.vertices[v].x, placed.vertices[v].y});
  return own(std::move(out), {count, 2});
}

std::tuple<double, double, double> circle(const BoundState& self, int row, int part, bool world_frame) {
  const PlacedPart placed = part_of(self, row, part, world_frame);
  if (placed.part.kind != Kind::circle) throw nb::value_error("this part is not a circle");
  return {placed.vertices[0].x, placed.vertices[0].y, placed.part.radius};
}

std::vector<std::string> parts(const BoundState& self, int row) {
  self.check_row(row);
  const char* names[] = {"circle", "polygon", "linestring", "room", "cells"};
  const int object = row % self.world->objects;
  const Shapes& shapes = *self.state.scenes[row / self.world->objects].shapes;
  std::vector<std::string> out;
  for (int p = 0; p < shapes.part_count(object); ++p) {
    out.push_back(names[static_cast<int>(shapes.parts[shapes.body[object].part + p].kind)]);
  }
  return out;
}

/// The cells of a row that is a map, or None.
nb::object cells_of(const BoundState& self, int row) {
  self.check_row(row);
  const Shapes& shapes = *self.state.scenes[row / self.world->objects].shapes;
  const OccupancyGrid* own = shapes.parts[shapes.body[row % self.world->objects].part].cells;
  for (const auto& grid : shapes.grids) {
    if (grid.get() == own) return nb::cast(std::const_pointer_cast<OccupancyGrid>(grid));
  }
  return nb::none();
}

}  // namespace

BoundState::BoundState(World& world_, const Seeds& seeds, bool history)
    : world(&world_), state(make_state(world_, seeds, history)) {
  expose();
}

BoundState::BoundState(World& world_, const BoundState& before, const std::vector<std::pair<BoundState*, int>>& origins)
    : world(&world_), state(world_, before.state.seed.data, before.state.keep_history, false) {
  if (world_.copies != 1 || before.world->copies != 1) throw nb::value_error("only single worlds can go on");
  if (static_cast<int>(origins.size()) != world_.objects) throw nb::value_error("one origin per object is needed");
  before.check_idle();
  std::vector<Origin> from;
  for (const auto& [source, object] : origins) {
    source->check_row(object);
    from.push_back({source->world, &source->state, object});
  }
  go_on(world_, state, *before.world, before.state, from);
  expose();
}

void BoundState::expose() {
  const std::size_t rows = state.rows, worlds = state.worlds, beams = state.ranges.size;
  const std::size_t extra_rows = state.extra_rows;
  pose = view<double>(state.pose.memory, {rows, 3});
  extra = view<double>(state.extra.memory, {rows, extra_rows});
  control = view<double>(state.control.memory, {rows, 3});
  twist = view<double>(state.twist.memory, {rows, 3});
  command = view<double>(state.command.memory, {rows, 3});
  drive = view<double>(state.drive.memory, {rows, 3});
  contact_time = view<double>(state.contact_time.memory, {rows});
  air_time = view<double>(state.air_time.memory, {rows});
  touching = view<std::uint8_t>(state.touching.memory, {rows});
  given = view<std::uint8_t>(state.given.memory, {rows});
  arrived = view<std::uint8_t>(state.arrived.memory, {rows});
  collided = view<std::uint8_t>(state.collided.memory, {rows});
  stopped = view<std::uint8_t>(state.stopped.memory, {rows});
  radius = view<double>(state.radius.memory, {rows});
  infeasible = view<std::int32_t>(state.infeasible.memory, {rows});
  goal = view<double>(state.goal.memory, {rows, 3});
  ranges = view<double>(state.ranges.memory, {beams});
  hits = view<std::int32_t>(state.hits.memory, {beams});
  valid = view<std::uint8_t>(state.valid.memory, {beams});
  beam_angles = view<double>(state.beam_angles.memory, {beams});
  velocities = view<double>(state.velocities.memory, {state.velocities.size});
  const bool foggy = world->fog.has_value();
  const std::size_t columns = foggy ? world->fog->columns : 0, fog_rows = foggy ? world->fog->rows : 0;
  explored = view<std::uint8_t>(state.explored.memory, {worlds, columns, fog_rows});
  count = view<std::int64_t>(state.count.memory, {worlds});
  scene = view<std::uint32_t>(state.scene_index.memory, {worlds});
  noise = view<std::uint32_t>(state.noise.memory, {worlds});
  seed = view<std::uint64_t>(state.seed.memory, {worlds});
  failed_placement = view<std::int32_t>(state.failed_placement.memory, {worlds});
}

State& BoundState::of(const World& named) {
  if (&named != world) throw nb::value_error("this state belongs to another world");
  return state;
}
void BoundState::check_idle() const {
  if (busy) throw std::runtime_error("this simulation is in use by another thread: give each thread its own");
}
void BoundState::check_row(int row) const {
  check_idle();
  if (row < 0 || row >= state.rows) throw nb::index_error("no such row");
}
void BoundState::check_world(int w) const {
  check_idle();
  if (w < 0 || w >= state.worlds) throw nb::index_error("no such world");
}
void BoundState::check_mask(const Mask& mask) const {
  if (static_cast<int>(mask.shape(0)) != state.worlds) throw nb::value_error("the mask needs one flag per world");
}

void bind_state(nb::module_& m) {
  using S = BoundState;
  nb::class_<S>(m, "State")
      .def(nb::init<World&, const Seeds&, bool>(), nb::arg("world"), nb::arg("seeds"), nb::arg("history"),
           nb::keep_alive<1, 2>())
      .def(nb::init<World&, const S&, const std::vector<std::pair<S*, int>>&>(), nb::arg("world"), nb::arg("before"),
           nb::arg("origins"), nb::keep_alive<1, 2>())
      .def_ro("pose", &S::pose)
      .def_ro("extra", &S::extra)
      .def_ro("control", &S::control)
      .def_ro("twist", &S::twist)
      .def_ro("command", &S::command)
      .def_ro("drive", &S::drive)
      .def_ro("contact_time", &S::contact_time)
      .def_ro("air_time", &S::air_time)
      .def_ro("touching", &S::touching)
      .def_ro("given", &S::given)
      .def_ro("arrived", &S::arrived)
      .def_ro("collided", &S::collided)
      .def_ro("stopped", &S::stopped)
      .def_ro("radius", &S::radius)
      .def_ro("infeasible", &S::infeasible)
      .def_ro("goal", &S::goal)
      .def_ro("ranges", &S::ranges)
      .def_ro("hits", &S::hits)
      .def_ro("valid", &S::valid)
      .def_ro("beam_angles", &S::beam_angles)
      .def_ro("velocities", &S::velocities)
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
          [](S& self, const Mask& mask, bool next_scene) {
            self.check_mask(mask);
            const Claim claim(self);
            nb::gil_scoped_release free;
            reset(*self.world, self.state, mask.data(), next_scene);
          },
          nb::arg("mask"), nb::arg("next_scene"))
      .def(
          "reseed",
          [](S& self, const Seeds& seeds, const Mask& mask) {
            self.check_mask(mask);
            self.check_idle();
            if (static_cast<int>(seeds.shape(0)) != self.state.worlds) throw nb::value_error("one seed per world");
            reseed(self.state, seeds.data(), mask.data());
          },
          nb::arg("seeds"), nb::arg("mask"))
      .def("refresh",
           [](S& self) {
             const Claim claim(self);
             refresh(*self.world, self.state);
           })
      .def(
          "done",
          [](const S& self, int w) {
            self.check_world(w);
            return done(*self.world, self.state, w);
          },
          nb::arg("world"))
      .def("events", &events, nb::arg("world"), nb::arg("start") = 0)
      .def("collision_pairs", &collision_pairs, nb::arg("world"))
      .def("contacts", &contacts, nb::arg("world"))
      .def("body", &body, nb::arg("row"))
      .def("pieces", &pieces, nb::arg("row"))
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
      .def("initial_state", &initial_state, nb::arg("row"))
      .def("velocity_world", &velocity_of, nb::arg("row"))
      .def("velocities_world", &velocities_of, nb::arg("world"))
      .def("near_row", &near_row, nb::arg("row"))
      .def("drive_velocity_world", &drive_velocity_of, nb::arg("row"))
      .def(
          "moved",
          [](S& self, int row) {
            self.check_row(row);
            moved(*self.world, self.state, row);
          },
          nb::arg("row"))
      .def(
          "in_view",
          [](S& self, int row, double angle, double reach, bool occlusion) {
            self.check_row(row);
            const int n = self.world->objects;
            return in_view(*self.world, self.state, row / n, row % n, {angle, reach, occlusion},
                           self.state.workspaces.front());
          },
          nb::arg("row"), nb::arg("angle"), nb::arg("reach"), nb::arg("occlusion"))
      .def(
          "reset_row",
          [](S& self, int row) {
            self.check_row(row);
            restart_row(*self.world, self.state, row);
            moved(*self.world, self.state, row);
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
      .def("vertices", &vertices, nb::arg("row"), nb::arg("part"), nb::arg("world_frame"))
      .def("circle", &circle, nb::arg("row"), nb::arg("part"), nb::arg("world_frame"))
      .def("parts", &parts, nb::arg("row"))
      .def("cells", &cells_of, nb::arg("row"))
      .def("trajectory", &trajectory, nb::arg("row"));
}

}  // namespace irsim
