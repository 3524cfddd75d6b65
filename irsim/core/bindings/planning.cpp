// Planning on maps that Python assembles.
#include <algorithm>
#include <cmath>

#include "bindings/helpers.hpp"
#include "planning/clearance.hpp"
#include "planning/plan.hpp"
#include "world/spec.hpp"

namespace irsim {
namespace {

using Two = std::array<double, 2>;
using Three = std::array<double, 3>;
using Parts = std::vector<PartSpec>;
/// Origin, cell size, columns and rows.
using Cells = std::tuple<Two, Two, int, int>;

constexpr double kOpen = 1.0 - 1e-6;  // share of a cell that leaves out its edge

Terrain make_terrain(const std::array<double, 4>& bounds, const std::vector<std::pair<Parts, Three>>& things) {
  Terrain terrain({bounds[0], bounds[1], bounds[2], bounds[3]});
  for (const auto& [parts, pose] : things) {
    if (!std::all_of(pose.begin(), pose.end(), [](double value) { return std::isfinite(value); }))
      throw nb::value_error("the pose of a thing on a terrain is finite");
    terrain.add(draw_outlines(parts, Draws({}, Stream::shape, 0)), {pose[0], pose[1], pose[2]});
  }
  terrain.build();
  return terrain;
}

Lattice lattice_of(const Cells& cells) {
  const auto& [origin, cell, nx, ny] = cells;
  if (nx < 1 || ny < 1 || !(cell[0] > 0.0 && cell[1] > 0.0))
    throw nb::value_error("a lattice needs cells of positive size");
  return {nx, ny, {origin[0], origin[1]}, {cell[0], cell[1]}};
}

/// A body of these parts; without parts, a body as large as one cell.
Body body_of(const Parts& parts, double heading, const Lattice& lattice) {
  if (parts.empty()) return Body::box(0.5 * kOpen * lattice.cell.x, 0.5 * kOpen * lattice.cell.y);
  Shapes shapes;
  shapes.add(draw_outlines(parts, Draws({}, Stream::shape, 0)), false);
  return Body::of(shapes, 0, heading, 0.0);
}

nb::object points(const std::vector<Vec2>& list) {
  std::vector<double> out;
  for (const Vec2& p : list) out.insert(out.end(), {p.x, p.y});
  return own(std::move(out), {list.size(), 2});
}

nb::tuple plan(const Terrain& terrain, const Planner& planner, const Parts& parts, double heading, const Two& start,
               const Two& goal, const Cells& cells, std::tuple<std::uint64_t, std::uint32_t, std::uint32_t> key,
               int object, std::uint64_t first_draw, bool smooth) {
  const Blockers blockers = terrain.blockers();
  const Lattice lattice = lattice_of(cells);
  Body body = body_of(parts, heading, lattice);
  const Space space{blockers, body, terrain.bounds(), true};
  SearchMemory memory;
  Plan found;
  {
    nb::gil_scoped_release free;
    const Draws draws(make_key(std::get<0>(key), std::get<1>(key), std::get<2>(key)), Stream::planner, object);
    const Problem problem{space, {start[0], start[1]}, {goal[0], goal[1]}, nullptr, &lattice, true, draws, first_draw,
                          memory};
    found = find_path(planner, problem);
    if (smooth && !found.path.empty()) {
      shorten(space, found.path);
      found.cost = path_length(found.path);
    }
  }
  std::vector<std::int32_t> parents(found.parents.begin(), found.parents.end());
  const std::size_t nodes = found.nodes.size();
  return nb::make_tuple(found.path.empty() ? nb::object(nb::none()) : points(found.path), found.cost,
                        points(found.nodes), own(std::move(parents), {nodes}), own(std::move(found.costs), {nodes}));
}

nb::object open_cells(const Terrain& terrain, const Parts& parts, double heading, const Cells& cells) {
  const Blockers blockers = terrain.blockers();
  const Lattice lattice = lattice_of(cells);
  Body body = body_of(parts, heading, lattice);
  const Space space{blockers, body, terrain.bounds(), true};
  std::vector<std::uint8_t> memory;
  OpenCells open(lattice, space, memory);
  const std::size_t nx = static_cast<std::size_t>(lattice.nx), ny = static_cast<std::size_t>(lattice.ny);
  std::vector<std::uint8_t> out(nx * ny);
  for (int i = 0; i < lattice.nx; ++i)
    for (int j = 0; j < lattice.ny; ++j) out[i * ny + j] = open.open(i, j);
  return own(std::move(out), {nx, ny});
}

bool collides(const Terrain& terrain, const Parts& parts, const Three& pose) {
  const Blockers blockers = terrain.blockers();
  Body body = body_of(parts, pose[2], {1, 1, {}, {1.0, 1.0}});
  return !Space{blockers, body, terrain.bounds(), true}.free({pose[0], pose[1]});
}

bool clear(const Terrain& terrain, const Parts& parts, double heading, const Two& from, const Two& to) {
  const Blockers blockers = terrain.blockers();
  Body body = body_of(parts, heading, {1, 1, {}, {1.0, 1.0}});
  const Space space{blockers, body, terrain.bounds(), true};
  return space.free({from[0], from[1]}) && space.clear({from[0], from[1]}, {to[0], to[1]});
}

Clearance make_clearance(const Terrain& terrain, const Cells& cells) {
  const Lattice lattice = lattice_of(cells);
  nb::gil_scoped_release free;
  return Clearance(terrain.blockers(), lattice);
}

/// (nx, ny) distances, i along x.
nb::object distances(const Clearance& clearance) {
  const std::size_t nx = static_cast<std::size_t>(clearance.lattice().nx);
  const std::size_t ny = static_cast<std::size_t>(clearance.lattice().ny);
  std::vector<float> out(nx * ny);
  for (std::size_t i = 0; i < nx; ++i)
    for (std::size_t j = 0; j < ny; ++j) out[i * ny + j] = clearance.distance()[j * nx + i];
  return own(std::move(out), {nx, ny});
}

}  // namespace

void bind_planning(nb::module_& m) {
#define IRSIM_BIND(Type) bind_fields<Type>(m, #Type);
  IRSIM_PLANNERS(IRSIM_BIND)
#undef IRSIM_BIND
  nb::class_<Terrain>(m, "Terrain")
      .def(
          "__init__",
          [](Terrain* self, const std::array<double, 4>& bounds, const std::vector<std::pair<Parts, Three>>& things) {
            new (self) Terrain(make_terrain(bounds, things));
          },
          nb::arg("bounds"), nb::arg("things"))
      .def("plan", &plan, nb::arg("planner"), nb::kw_only(), nb::arg("parts"), nb::arg("heading"), nb::arg("start"),
           nb::arg("goal"), nb::arg("cells"), nb::arg("key"), nb::arg("object"), nb::arg("first_draw"),
           nb::arg("smooth"))
      .def("open_cells", &open_cells, nb::arg("parts"), nb::arg("heading"), nb::arg("cells"))
      .def("collides", &collides, nb::arg("parts"), nb::arg("pose"))
      .def("clear", &clear, nb::arg("parts"), nb::arg("heading"), nb::arg("start"), nb::arg("goal"));
  nb::class_<Clearance>(m, "Clearance")
      .def(
          "__init__",
          [](Clearance* self, const Terrain& terrain, const Cells& cells) {
            new (self) Clearance(make_clearance(terrain, cells));
          },
          nb::arg("terrain"), nb::arg("cells"))
      .def_prop_ro("distance", &distances)
      .def(
          "widest",
          [](const Clearance& c, const Two& from, const Two& to, double reach) {
            const Clearance::Way way = c.widest({from[0], from[1]}, {to[0], to[1]}, reach);
            const Vec2 at = way.node < 0 ? Vec2{kNone, kNone} : c.lattice().at(way.node);
            return std::make_tuple(way.room, at.x, at.y);
          },
          nb::arg("start"), nb::arg("goal"), nb::arg("reach"))
      .def(
          "climb",
          [](const Clearance& c, const Two& from, double reach) {
            const Vec2 top = c.climb({from[0], from[1]}, reach);
            return std::make_tuple(top.x, top.y);
          },
          nb::arg("start"), nb::arg("reach"))
      .def(
          "way",
          [](const Clearance& c, const Two& from, const Two& to, double room) {
            return points(c.way({from[0], from[1]}, {to[0], to[1]}, room));
          },
          nb::arg("start"), nb::arg("goal"), nb::arg("room"));
}

}  // namespace irsim
