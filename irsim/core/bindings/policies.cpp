// Functions for policies, which decide in Python for many rows at once.
#include "bindings/bound_state.hpp"
#include "phases.hpp"
#include "surroundings/bounding_circles.hpp"

namespace irsim {
namespace {

using Rows = nb::ndarray<const std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Velocities = nb::ndarray<const double, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;

void check_rows(const State& state, const Rows& rows) {
  for (std::size_t k = 0; k < rows.shape(0); ++k) {
    if (rows.data()[k] < 0 || rows.data()[k] >= state.rows) throw nb::index_error("no such row");
  }
}

void follow_rows(World& world, BoundState& bound, const Rows& rows, const Velocities& velocities) {
  State& state = bound.of(world);
  check_rows(state, rows);
  if (velocities.shape(0) != rows.shape(0)) throw nb::value_error("there must be one velocity per row");
  for (std::size_t k = 0; k < rows.shape(0); ++k) {
    const int row = static_cast<int>(rows.data()[k]);
    const Vec2 velocity{velocities.data()[2 * k], velocities.data()[2 * k + 1]};
    state.commanded[row] = velocity;
    command_velocity(world, state, row / world.objects, row % world.objects, velocity, {});
  }
}

nb::object circles_of(World& world, BoundState& bound) {
  const State& state = bound.of(world);
  std::vector<double> out;
  out.reserve(3 * static_cast<std::size_t>(state.rows));
  std::vector<BoundingCircle> circles;
  for (int w = 0; w < state.worlds; ++w) {
    bounding_circles(world, state, w, circles);
    for (const BoundingCircle& circle : circles)
      out.insert(out.end(), {circle.centre.x, circle.centre.y, circle.radius});
  }
  return own(std::move(out), {static_cast<std::size_t>(state.rows), 3});
}

}  // namespace

void bind_policies(nb::module_& m) {
  m.def("follow_rows", &follow_rows, nb::arg("world"), nb::arg("state"), nb::arg("rows"), nb::arg("velocities"));
  m.def("bounding_circles", &circles_of, nb::arg("world"), nb::arg("state"));
}

}  // namespace irsim
