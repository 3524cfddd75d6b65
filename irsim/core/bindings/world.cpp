// The class `World` and the specifications it is made from.
#include "world/world.hpp"
#include "bindings/helpers.hpp"
#include "world/features.hpp"
#include "world/spec.hpp"

namespace irsim {

void bind_world(nb::module_& m) {
  bind_fields<RouteOptions>(m, "RouteOptions");
  bind_fields<ObjectSpec>(m, "ObjectSpec");
  bind_fields<RandomPlacement>(m, "RandomPlacement");
  bind_fields<Perturbation>(m, "Perturbation");
  bind_fields<FogView>(m, "FogView");
  bind_fields<Fog>(m, "Fog");
  nb::class_<World>(m, "World")
      .def(nb::init<double, int, double, std::vector<ObjectSpec>, std::vector<RandomPlacement>, int, std::optional<Fog>,
                    std::vector<Perturbation>>(),
           nb::kw_only(), nb::arg("step_time"), nb::arg("collision_mode"), nb::arg("gravity"), nb::arg("objects"),
           nb::arg("placements"), nb::arg("copies"), nb::arg("fog") = nb::none(),
           nb::arg("perturbations") = std::vector<Perturbation>())
      .def_ro("copies", &World::copies)
      .def_ro("objects", &World::objects)
      .def_ro("step_time", &World::step_time)
      .def_rw("collision_mode", &World::collision_mode)
      .def_rw("after_arrival", &World::after_arrival)
      .def_rw("extent", &World::extent)
      .def_ro("beams_per_world", &World::beams_per_world)
      .def_ro("velocities_per_world", &World::velocities_per_world)
      .def("scans",
           [](const World& world) {
             std::vector<std::tuple<int, int, int>> out;
             for (const Scan& scan : world.scans)
               out.emplace_back(scan.mount.object, scan.mount.first, scan.mount.count);
             return out;
           })
      .def("velocity_slices", [](const World& world) {
        std::vector<std::tuple<int, int>> out;
        for (const Scan& scan : world.scans) out.emplace_back(scan.mount.first_velocity, scan.mount.velocity_rows);
        return out;
      });
}

}  // namespace irsim
