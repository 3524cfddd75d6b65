// The functions `clearances`, `least_clearances` and `free_lines`: distances and lines of sight over recorded poses.
#include "runs/clearances.hpp"
#include "bindings/bound_state.hpp"
#include "runs/free_lines.hpp"

namespace irsim {
namespace {

using Poses = nb::ndarray<const double, nb::shape<-1, -1, 3>, nb::c_contig, nb::device::cpu>;

/// Check the arguments of both functions, and read what each object is to a robot.
std::vector<ObjectKind> kinds_of(const World& world, const Poses& poses, const std::vector<int>& robots,
                                 const Mask& codes) {
  const std::size_t n = world.objects;
  if (poses.shape(1) != n) throw nb::value_error("poses must have the shape (rows, objects, 3)");
  if (codes.shape(0) != n) throw nb::value_error("kinds must have one entry per object");
  for (const int robot : robots) {
    if (robot < 0 || robot >= world.objects) throw nb::index_error("no such object");
  }
  std::vector<ObjectKind> kinds;
  for (std::size_t i = 0; i < n; ++i) kinds.push_back(static_cast<ObjectKind>(std::min<int>(codes.data()[i], kKinds)));
  return kinds;
}

/// The geometry of all static objects; objects that have not appeared yet are at their starts.
std::shared_ptr<const Fixed> all_fixed(const World& world, const State& state, int w) {
  std::vector<Pose> poses;
  bool whole = true;
  for (const int i : world.fixed_objects) {
    const int row = w * world.objects + i;
    whole = whole && !state.absent(row);
    poses.push_back(state.absent(row) ? state.initial_pose[row] : state.pose[row]);
  }
  return whole ? state.scenes[w].fixed : make_fixed(world, *state.scenes[w].shapes, std::move(poses));
}

nb::tuple clearances_of(World& world, BoundState& bound, int w, const Poses& poses, const std::vector<int>& robots,
                        const Mask& codes) {
  const State& state = bound.of(world);
  bound.check_world(w);
  const std::vector<ObjectKind> kinds = kinds_of(world, poses, robots, codes);
  const std::size_t rows = poses.shape(0), count = rows * robots.size() * kKinds;
  std::vector<double> distance(count);
  std::vector<std::int32_t> partner(count);
  const std::shared_ptr<const Shapes> shapes = state.scenes[w].shapes;
  const std::shared_ptr<const Fixed> fixed = all_fixed(world, state, w);
  {
    nb::gil_scoped_release free;
    clearances(world, *shapes, *fixed, reinterpret_cast<const Pose*>(poses.data()), rows, robots, kinds,
               distance.data(), partner.data());
  }
  const std::size_t each = robots.size(), kept = kKinds;
  return nb::make_tuple(own(std::move(distance), {rows, each, kept}), own(std::move(partner), {rows, each, kept}));
}

nb::tuple least_clearances_of(World& world, BoundState& bound, int w, const Poses& poses,
                              const std::vector<int>& robots, const Mask& codes, const std::vector<int>& ends) {
  const State& state = bound.of(world);
  bound.check_world(w);
  const std::vector<ObjectKind> kinds = kinds_of(world, poses, robots, codes);
  const std::size_t each = robots.size(), rows = poses.shape(0);
  if (ends.size() != each) throw nb::value_error("ends must have one entry per robot");
  if (rows == 0) throw nb::value_error("poses must have at least one row");
  std::vector<double> distance(each);
  std::vector<std::int32_t> partner(each), row(each);
  const std::shared_ptr<const Shapes> shapes = state.scenes[w].shapes;
  const std::shared_ptr<const Fixed> fixed = all_fixed(world, state, w);
  {
    nb::gil_scoped_release free;
    least_clearances(world, *shapes, *fixed, reinterpret_cast<const Pose*>(poses.data()), rows, robots, kinds, ends,
                     distance.data(), partner.data(), row.data());
  }
  return nb::make_tuple(own(std::move(distance), {each}), own(std::move(partner), {each}), own(std::move(row), {each}));
}

using Points = nb::ndarray<const double, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;

nb::object free_lines_of(World& world, BoundState& bound, int w, const Points& start, const Points& end,
                         const Mask& blocking) {
  const State& state = bound.of(world);
  bound.check_world(w);
  const std::size_t count = start.shape(0);
  if (end.shape(0) != count) throw nb::value_error("there must be one end per start");
  if (blocking.shape(0) != static_cast<std::size_t>(world.objects))
    throw nb::value_error("blocking must have one entry per object");
  std::vector<std::uint8_t> out(count);
  const std::shared_ptr<const Shapes> shapes = state.scenes[w].shapes;
  const std::shared_ptr<const Fixed> fixed = all_fixed(world, state, w);
  {
    nb::gil_scoped_release free;
    free_lines(world, *shapes, *fixed, reinterpret_cast<const Vec2*>(start.data()),
               reinterpret_cast<const Vec2*>(end.data()), count, blocking.data(), out.data());
  }
  return own(std::move(out), {count});
}

}  // namespace

void bind_clearance(nb::module_& m) {
  m.def("clearances", &clearances_of, nb::arg("world"), nb::arg("state"), nb::arg("index"), nb::arg("poses"),
        nb::arg("robots"), nb::arg("kinds"));
  m.def("least_clearances", &least_clearances_of, nb::arg("world"), nb::arg("state"), nb::arg("index"),
        nb::arg("poses"), nb::arg("robots"), nb::arg("kinds"), nb::arg("ends"));
  m.def("free_lines", &free_lines_of, nb::arg("world"), nb::arg("state"), nb::arg("index"), nb::arg("start"),
        nb::arg("end"), nb::arg("blocking"));
}

}  // namespace irsim
