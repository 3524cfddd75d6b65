// Shapes of single rows of a state, as Python sees them.
#include "bindings/bound_state.hpp"
#include "phases.hpp"

namespace irsim {
namespace {

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

/// The other objects whose bounding boxes meet the box of a row, at the present poses.
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

/// A part with its vertices in the body frame or at the present pose of the row.
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

/// The cells of a row that is a map; None for other rows.
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

void bind_row_geometry(nb::class_<BoundState>& state) {
  state.def("body", &body, nb::arg("row"))
      .def("pieces", &pieces, nb::arg("row"))
      .def("near_row", &near_row, nb::arg("row"))
      .def("vertices", &vertices, nb::arg("row"), nb::arg("part"), nb::arg("world_frame"))
      .def("circle", &circle, nb::arg("row"), nb::arg("part"), nb::arg("world_frame"))
      .def("parts", &parts, nb::arg("row"))
      .def("cells", &cells_of, nb::arg("row"));
}

}  // namespace irsim
