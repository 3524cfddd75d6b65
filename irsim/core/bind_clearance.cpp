// Distances over recorded poses.
#include "bind_state.hpp"
#include "clearance.hpp"

namespace irsim {
namespace {

using Poses = nb::ndarray<const double, nb::shape<-1, -1, 3>, nb::c_contig, nb::device::cpu>;

nb::tuple clearances_of(World& world, BoundState& bound, int w, const Poses& poses, const std::vector<int>& robots,
                        const Mask& company) {
  const State& state = bound.of(world);
  bound.check_world(w);
  const std::size_t n = world.objects, rows = poses.shape(0);
  if (poses.shape(1) != n) throw nb::value_error("poses must have the shape (rows, objects, 3)");
  if (company.shape(0) != n) throw nb::value_error("company must have one entry per object");
  std::vector<Company> kinds;
  for (std::size_t i = 0; i < n; ++i)
    kinds.push_back(static_cast<Company>(std::min<int>(company.data()[i], kCompanies)));
  for (const int robot : robots) {
    if (robot < 0 || robot >= world.objects) throw nb::index_error("no such object");
  }
  const std::size_t count = rows * robots.size() * kCompanies;
  std::vector<double> distance(count);
  std::vector<std::int32_t> partner(count);
  const std::shared_ptr<const Shapes> shapes = state.scenes[w].shapes;
  const std::shared_ptr<const Fixed> fixed = state.scenes[w].fixed;
  {
    nb::gil_scoped_release free;
    clearances(world, *shapes, *fixed, reinterpret_cast<const Pose*>(poses.data()), rows, robots, kinds,
               distance.data(), partner.data());
  }
  const std::size_t each = robots.size(), kept = kCompanies;
  return nb::make_tuple(own(std::move(distance), {rows, each, kept}), own(std::move(partner), {rows, each, kept}));
}

}  // namespace

void bind_clearance(nb::module_& m) {
  m.def("clearances", &clearances_of, nb::arg("world"), nb::arg("state"), nb::arg("index"), nb::arg("poses"),
        nb::arg("robots"), nb::arg("company"));
}

}  // namespace irsim
