// Functions for policies, which decide in Python for many rows at once.
#include <optional>

#include "bindings/bound_state.hpp"
#include "phases.hpp"
#include "surroundings/bounding_circles.hpp"
#include "surroundings/perception.hpp"

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

nb::object believed_rows(World& world, BoundState& bound, const Rows& rows) {
  const State& state = bound.of(world);
  check_rows(state, rows);
  const std::size_t count = rows.shape(0);
  std::vector<double> poses, velocities;
  std::vector<std::uint8_t> arrived;
  for (std::size_t k = 0; k < count; ++k) {
    const int row = static_cast<int>(rows.data()[k]), object = row % world.objects;
    const Pose pose = believed_pose(world, state, row);
    const Vec3& twist = state.twist[row];
    const bool estimated = estimates(world, object);
    const Vec2 velocity =
        estimated ? rotate({twist[0], twist[1]}, unit(pose.theta - state.pose[row].theta)) : Vec2{twist[0], twist[1]};
    poses.insert(poses.end(), {pose.x, pose.y, pose.theta});
    velocities.insert(velocities.end(), {velocity.x, velocity.y});
    arrived.push_back((estimated ? state.believes_arrived : state.arrived)[row]);
  }
  return nb::make_tuple(own(std::move(poses), {count, 3}), own(std::move(velocities), {count, 2}),
                        own(std::move(arrived), {count}));
}

/// The belief of one object in place of the truth, between `enter` and `exit`, while programs decide for it.
class HeldBelief {
 public:
  HeldBelief(World& world, BoundState& bound, int row) : world_(world), bound_(bound), row_(row) {
    bound.of(world);
    bound.check_row(row);
  }
  void enter() {
    belief_.emplace(world_, bound_.state, row_ / world_.objects, row_ % world_.objects, work_, replaced_);
  }
  void exit(const nb::object&, const nb::object&, const nb::object&) { belief_.reset(); }

 private:
  World& world_;
  BoundState& bound_;
  int row_;
  Workspace work_;
  Replaced replaced_;
  std::optional<Belief> belief_;
};

}  // namespace

void bind_policies(nb::module_& m) {
  m.def("follow_rows", &follow_rows, nb::arg("world"), nb::arg("state"), nb::arg("rows"), nb::arg("velocities"));
  m.def("believed_rows", &believed_rows, nb::arg("world"), nb::arg("state"), nb::arg("rows"));
  nb::class_<HeldBelief>(m, "Belief")
      .def(nb::init<World&, BoundState&, int>(), nb::arg("world"), nb::arg("state"), nb::arg("row"),
           nb::keep_alive<1, 2>(), nb::keep_alive<1, 3>())
      .def("__enter__", &HeldBelief::enter)
      .def("__exit__", &HeldBelief::exit, nb::arg("kind").none(), nb::arg("error").none(), nb::arg("trace").none());
  m.def("bounding_circles", &circles_of, nb::arg("world"), nb::arg("state"));
}

}  // namespace irsim
