// The class `World` and the specifications it is made from.
#include "world/world.hpp"
#include "bindings/helpers.hpp"
#include "world/features.hpp"
#include "world/spec.hpp"

namespace irsim {

void bind_world(nb::module_& m) {
  bind_fields<RouteOptions>(m, "RouteOptions");
  bind_fields<Actuation>(m, "Actuation");
  bind_fields<SensorTiming>(m, "SensorTiming");
  m.def(
      "shown_step",
      [](const SensorTiming& timing, double step_time, std::int64_t step) {
        return timetable_of(timing, step_time).shown(step);
      },
      nb::arg("timing"), nb::arg("step_time"), nb::arg("step"));
  bind_fields<ObjectSpec>(m, "ObjectSpec");
  bind_fields<RandomPlacement>(m, "RandomPlacement");
  bind_fields<CircleCrossing>(m, "CircleCrossing");
  bind_fields<SquareCrossing>(m, "SquareCrossing");
  bind_fields<Perturbation>(m, "Perturbation");
  bind_fields<Variation>(m, "Variation");
  bind_fields<Level>(m, "Level");
  bind_fields<View>(m, "View");
  bind_fields<Ground>(m, "Ground");
  bind_fields<Fog>(m, "Fog");
  nb::class_<World>(m, "World")
      .def(
          "__init__",
          [](World* self, double step_time, int collision_mode, double gravity, std::vector<ObjectSpec> objects,
             std::vector<Placement> placements, int copies, std::optional<Fog> fog,
             std::vector<Perturbation> perturbations, const std::vector<PartSpec>& zones, std::vector<View> views,
             const std::vector<int>& targets, std::vector<Ground> grounds) {
            new (self) World(step_time, collision_mode, gravity, std::move(objects), std::move(placements), copies,
                             std::move(fog), std::move(perturbations),
                             Zones(draw_outlines(zones, Draws({}, Stream::shape, 0)), std::move(grounds)),
                             std::move(views), targets);
          },
          nb::kw_only(), nb::arg("step_time"), nb::arg("collision_mode"), nb::arg("gravity"), nb::arg("objects"),
          nb::arg("placements"), nb::arg("copies"), nb::arg("fog") = nb::none(),
          nb::arg("perturbations") = std::vector<Perturbation>(), nb::arg("zones") = std::vector<PartSpec>(),
          nb::arg("views") = std::vector<View>(), nb::arg("targets") = std::vector<int>(),
          nb::arg("grounds") = std::vector<Ground>())
      .def_ro("copies", &World::copies)
      .def_ro("objects", &World::objects)
      .def_ro("step_time", &World::step_time)
      .def_rw("collision_mode", &World::collision_mode)
      .def_rw("after_arrival", &World::after_arrival)
      .def_rw("contacts", &World::contacts)
      .def_prop_rw(
          "integration", [](const World& world) { return static_cast<int>(world.integration); },
          [](World& world, int value) { world.integration = static_cast<Integration>(value); })
      .def_rw("extent", &World::extent)
      .def("set_levels", &World::set_levels, nb::arg("levels"), nb::arg("speeds"))
      .def("set_variants", &World::set_variants, nb::arg("variants"))
      .def_ro("beams_per_world", &World::beams_per_world)
      .def_ro("velocities_per_world", &World::velocities_per_world)
      .def("scans",
           [](const World& world) {
             std::vector<std::tuple<int, int, int>> out;
             for (const Scan& scan : world.scans)
               out.emplace_back(scan.mount.object, scan.mount.first, scan.mount.count);
             return out;
           })
      .def_ro("readings_per_world", &World::readings_per_world)
      .def("gauges",
           [](const World& world) {
             std::vector<std::tuple<int, int, int>> out;
             for (const Scan& gauge : world.gauges)
               out.emplace_back(gauge.mount.object, gauge.mount.first_reading, gauge.mount.readings);
             return out;
           })
      .def("velocity_slices", [](const World& world) {
        std::vector<std::tuple<int, int>> out;
        for (const Scan& scan : world.scans) out.emplace_back(scan.mount.first_velocity, scan.mount.velocity_rows);
        return out;
      });
}

}  // namespace irsim
