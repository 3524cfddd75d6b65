// Observation parts: over the rows of a simulation at once, and over arrays of what robots observed.
#include "bindings/observing.hpp"
#include "learning/write_parts.hpp"
#include "parallel.hpp"
#include "surroundings/gaps.hpp"

namespace irsim {
namespace {

template <class T, int N>
using Given = nb::ndarray<const T, nb::ndim<N>, nb::c_contig, nb::device::cpu>;
using RowNumbers = Given<std::int64_t, 1>;
using Output = nb::ndarray<float, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

constexpr std::size_t kRowsPerThread = 64;
constexpr const char* kRow = "there must be one row for each robot";
constexpr const char* kMember = "there must be one row for each neighbor of each robot";

void check_each(const State& state, const RowNumbers& rows) {
  for (std::size_t b = 0; b < rows.shape(0); ++b) {
    if (rows.data()[b] < 0 || rows.data()[b] >= state.rows) throw nb::index_error("no such row");
  }
}

Vec2 vector_at(const double* numbers, std::size_t k) { return {numbers[2 * k], numbers[2 * k + 1]}; }
template <class Triple>
Triple triple_at(const double* numbers, std::size_t k) {
  return {numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2]};
}

/// The input of a part without a simulation: the arrays of `irsim.policies.Observations`.
struct SeenRows {
  Given<double, 2> pose, velocity, commanded, control, low, high, goal;
  Given<double, 1> steering, yaw_rate, goal_threshold, radius;
  Given<std::uint8_t, 1> arrived;
  std::size_t neighbors = 0;  // of each robot; the arrays below have no memory without any
  Given<std::uint8_t, 2> present, neighbor_arrived, is_robot;
  Given<double, 3> position, neighbor_velocity;
  Given<double, 2> heading, neighbor_radius, extent, own_extent;
  std::size_t beams = 0;
  Given<double, 2> ranges;
  double range_max = 0.0;
  std::vector<Given<std::uint8_t, 2>> cells;  // keeps the memory of the pictures
  std::vector<Picture> pictures;
  std::vector<int> picture_of;  // (B,), empty without pictures

  SeenRows(const Given<double, 2>& pose_, const Given<double, 1>& steering_, const Given<double, 2>& velocity_,
           const Given<double, 2>& commanded_, const Given<double, 1>& yaw_rate_, const Given<double, 2>& control_,
           const Given<double, 2>& low_, const Given<double, 2>& high_, const Given<double, 2>& goal_,
           const Given<double, 1>& goal_threshold_, const Given<double, 1>& radius_,
           const Given<std::uint8_t, 1>& arrived_)
      : pose(pose_),
        velocity(velocity_),
        commanded(commanded_),
        control(control_),
        low(low_),
        high(high_),
        goal(goal_),
        steering(steering_),
        yaw_rate(yaw_rate_),
        goal_threshold(goal_threshold_),
        radius(radius_),
        arrived(arrived_) {
    for (const auto* array : {&pose, &control, &low, &high, &goal}) {
      expect_fit(array->shape(0) == size() && array->shape(1) == 3, "a robot has three numbers here");
    }
    for (const auto* array : {&velocity, &commanded}) {
      expect_fit(array->shape(0) == size() && array->shape(1) == 2, "a velocity has two numbers");
    }
    for (const auto* array : {&steering, &yaw_rate, &goal_threshold, &radius})
      expect_fit(array->size() == size(), kRow);
    expect_fit(arrived.size() == size(), kRow);
  }

  void set_neighbors(const Given<std::uint8_t, 2>& present_, const Given<double, 3>& position_,
                     const Given<double, 2>& heading_, const Given<double, 3>& velocity_,
                     const Given<double, 2>& radius_, const Given<std::uint8_t, 2>& arrived_,
                     const Given<std::uint8_t, 2>& robot_, const Given<double, 2>& extent_,
                     const Given<double, 2>& own_extent_) {
    const std::size_t count = present_.shape(1);
    for (const auto* array : {&present_, &arrived_, &robot_}) {
      expect_fit(array->shape(0) == size() && array->shape(1) == count, kMember);
    }
    for (const auto* array : {&heading_, &radius_, &extent_, &own_extent_}) {
      expect_fit(array->shape(0) == size() && array->shape(1) == count, kMember);
    }
    for (const auto* array : {&position_, &velocity_}) {
      expect_fit(array->shape(0) == size() && array->shape(1) == count && array->shape(2) == 2, kMember);
    }
    neighbors = count;
    present = present_, position = position_, heading = heading_, neighbor_velocity = velocity_;
    neighbor_radius = radius_, neighbor_arrived = arrived_, is_robot = robot_;
    extent = extent_, own_extent = own_extent_;
  }

  void set_scan(const Given<double, 2>& ranges_, double range_max_) {
    expect_fit(ranges_.shape(0) == size(), kRow);
    ranges = ranges_, range_max = range_max_;
    beams = ranges.shape(1);
  }

  void set_pictures(const std::vector<std::tuple<Given<std::uint8_t, 2>, std::pair<double, double>, double>>& given,
                    const std::vector<int>& which) {
    expect_fit(which.size() == size(), kRow);
    for (const int one : which) expect_fit(one >= 0 && static_cast<std::size_t>(one) < given.size(), "no such picture");
    cells.clear(), pictures.clear();
    for (const auto& [occupied, origin, resolution] : given) {
      cells.push_back(occupied);
      pictures.push_back(
          {occupied.data(), occupied.shape(0), occupied.shape(1), {origin.first, origin.second}, resolution});
    }
    picture_of = which;
  }

  std::size_t size() const { return pose.shape(0); }

  Seen at(std::size_t row, Near& near) const {
    Seen seen;
    seen.pose = triple_at<Pose>(pose.data(), row);
    seen.ahead = unit(seen.pose.theta);
    seen.steering = steering.data()[row];
    seen.velocity = vector_at(velocity.data(), row);
    seen.commanded = vector_at(commanded.data(), row);
    seen.yaw_rate = yaw_rate.data()[row];
    seen.control = triple_at<Vec3>(control.data(), row);
    seen.low = triple_at<Vec3>(low.data(), row), seen.high = triple_at<Vec3>(high.data(), row);
    seen.goal = triple_at<Pose>(goal.data(), row);
    seen.goal_threshold = goal_threshold.data()[row];
    seen.radius = radius.data()[row];
    seen.arrived = arrived.data()[row] ? 1.0 : 0.0;
    near.neighbors.clear();
    for (std::size_t k = row * neighbors; k < (row + 1) * neighbors; ++k) {
      near.neighbors.push_back({vector_at(position.data(), k), heading.data()[k], unit(heading.data()[k]),
                                vector_at(neighbor_velocity.data(), k), neighbor_radius.data()[k],
                                neighbor_arrived.data()[k] ? 1.0 : 0.0, is_robot.data()[k] ? 1.0 : 0.0,
                                present.data()[k] != 0, extent.data()[k], own_extent.data()[k]});
    }
    seen.neighbors = near.neighbors.data(), seen.neighbor_count = neighbors;
    seen.beams = beams;
    seen.ranges = beams > 0 ? ranges.data() + row * beams : nullptr;
    seen.range_max = range_max;
    if (!picture_of.empty()) seen.picture = &pictures[picture_of[row]];
    return seen;
  }
};

template <class Options>
nb::object look(const Options& options, const SeenRows& rows) {
  const std::size_t count = rows.size(), set = members(options), numbers = width(options);
  const std::size_t size = (set > 0 ? set : 1) * numbers;
  std::vector<double> out(count * size);
  std::vector<std::uint8_t> mask(count * set);
  {
    nb::gil_scoped_release free;
    Near near;
    for (std::size_t b = 0; b < count; ++b)
      run(options, rows.at(b, near), out.data() + b * size, mask.data() + b * set);
  }
  if (set == 0) return nb::make_tuple(own(std::move(out), {count, numbers}), nb::none());
  return nb::make_tuple(own(std::move(out), {count, set, numbers}), own(std::move(mask), {count, set}));
}

void observe_rows(World& world, BoundState& bound, const Looking& looking, const std::vector<PartAtColumn>& parts,
                  const RowNumbers& rows, const Output& out, int threads) {
  State& state = bound.of(world);
  const Claim claim(bound);
  expect_fit(out.shape(0) == rows.shape(0), "there must be one row of numbers for each row");
  check_looking(world, looking);
  check_parts(parts, out.shape(1));
  check_each(state, rows);
  nb::gil_scoped_release free;
  in_parts(state.crew, rows.shape(0), threads, kRowsPerThread, [&](std::size_t first, std::size_t last) {
    PartWriter writer(world, state, looking, parts);
    for (std::size_t b = first; b < last; ++b)
      writer.write(static_cast<int>(rows.data()[b]), out.data() + b * out.shape(1));
  });
}

nb::object gaps_of(World& world, BoundState& bound, const RowNumbers& rows, const Mask& codes, double reach,
                   int threads) {
  State& state = bound.of(world);
  check_each(state, rows);
  const std::vector<ObjectKind> kinds = kinds_of(world, codes);
  const std::size_t count = rows.shape(0), each = kKinds;
  std::vector<double> out(count * each);
  {
    const Claim claim(bound);
    nb::gil_scoped_release free;
    in_parts(state.crew, count, threads, kRowsPerThread, [&](std::size_t first, std::size_t last) {
      for (std::size_t b = first; b < last; ++b)
        gaps(world, state, static_cast<int>(rows.data()[b]), kinds, reach, out.data() + b * each);
    });
  }
  return own(std::move(out), {count, each});
}

nb::object neighbors_of(World& world, BoundState& bound, const Looking& looking, const RowNumbers& rows) {
  const State& state = bound.of(world);
  check_each(state, rows);
  check_looking(world, looking);
  const std::size_t count = rows.shape(0), most = looking.neighbors;
  std::vector<std::int64_t> index(count * most, -1);
  std::vector<std::uint8_t> present(count * most), arrived(count * most), robot(count * most);
  std::vector<double> position(2 * count * most), heading(count * most), velocity(2 * count * most),
      radius(count * most), extent(count * most), own_extent(count * most);
  const Observer observer(world, state, looking);
  Near near;
  for (std::size_t b = 0; b < count; ++b) {
    const Seen seen = observer.see(static_cast<int>(rows.data()[b]), near);
    for (std::size_t n = 0; n < seen.neighbor_count; ++n) {
      const Neighbor& other = seen.neighbors[n];
      const std::size_t k = b * most + n;
      index[k] = near.nearest.object[n];
      present[k] = 1, arrived[k] = other.arrived > 0.0, robot[k] = other.is_robot > 0.0;
      position[2 * k] = other.position.x, position[2 * k + 1] = other.position.y;
      velocity[2 * k] = other.velocity.x, velocity[2 * k + 1] = other.velocity.y;
      heading[k] = other.heading, radius[k] = other.radius;
      extent[k] = other.extent, own_extent[k] = other.own_extent;
    }
  }
  return nb::make_tuple(own(std::move(present), {count, most}), own(std::move(index), {count, most}),
                        own(std::move(position), {count, most, 2}), own(std::move(heading), {count, most}),
                        own(std::move(velocity), {count, most, 2}), own(std::move(radius), {count, most}),
                        own(std::move(arrived), {count, most}), own(std::move(robot), {count, most}),
                        own(std::move(extent), {count, most}), own(std::move(own_extent), {count, most}));
}

}  // namespace

void check_looking(const World& world, const Looking& looking) {
  const std::size_t n = world.objects;
  expect_fit(looking.steered.size() == n && looking.first_beam.size() == n, kObject);
}

void check_parts(const std::vector<PartAtColumn>& parts, std::size_t columns) {
  for (const auto& [part, column] : parts)
    expect_fit(column + numbers_of(part) <= columns, "the parts do not fit into the observation");
}

std::vector<ObjectKind> kinds_of(const World& world, const Mask& codes) {
  expect_fit(codes.shape(0) == static_cast<std::size_t>(world.objects), kObject);
  std::vector<ObjectKind> kinds;
  for (std::size_t i = 0; i < codes.shape(0); ++i)
    kinds.push_back(static_cast<ObjectKind>(std::min<int>(codes.data()[i], kKinds)));
  return kinds;
}

void bind_observing(nb::module_& m) {
  nb::class_<Looking>(m, "Looking")
      .def(nb::init<int, double, bool, bool, std::vector<std::uint8_t>, std::vector<int>, int, double>(),
           nb::arg("neighbors"), nb::arg("reach"), nb::arg("statics"), nb::arg("extents"), nb::arg("steered"),
           nb::arg("first_beam"), nb::arg("beams"), nb::arg("range_max"));
  nb::class_<SeenRows>(m, "SeenRows")
      .def(nb::init<const Given<double, 2>&, const Given<double, 1>&, const Given<double, 2>&, const Given<double, 2>&,
                    const Given<double, 1>&, const Given<double, 2>&, const Given<double, 2>&, const Given<double, 2>&,
                    const Given<double, 2>&, const Given<double, 1>&, const Given<double, 1>&,
                    const Given<std::uint8_t, 1>&>(),
           nb::kw_only(), nb::arg("pose"), nb::arg("steering"), nb::arg("velocity"), nb::arg("commanded"),
           nb::arg("yaw_rate"), nb::arg("control"), nb::arg("low"), nb::arg("high"), nb::arg("goal"),
           nb::arg("goal_threshold"), nb::arg("radius"), nb::arg("arrived"))
      .def("set_neighbors", &SeenRows::set_neighbors, nb::arg("present"), nb::arg("position"), nb::arg("heading"),
           nb::arg("velocity"), nb::arg("radius"), nb::arg("arrived"), nb::arg("robot"), nb::arg("extent"),
           nb::arg("own_extent"))
      .def("set_scan", &SeenRows::set_scan, nb::arg("ranges"), nb::arg("range_max"))
      .def("set_pictures", &SeenRows::set_pictures, nb::arg("pictures"), nb::arg("which"));
#define IRSIM_LOOK(Type) m.def("look", &look<Type>, nb::arg("options"), nb::arg("rows"));
  IRSIM_PARTS(IRSIM_LOOK)
#undef IRSIM_LOOK
  m.def("observe_rows", &observe_rows, nb::arg("world"), nb::arg("state"), nb::arg("looking"), nb::arg("parts"),
        nb::arg("rows"), nb::arg("out"), nb::arg("threads") = 1);
  m.def("gaps", &gaps_of, nb::arg("world"), nb::arg("state"), nb::arg("rows"), nb::arg("kinds"), nb::arg("reach"),
        nb::arg("threads") = 1);
  m.def("find_neighbors", &neighbors_of, nb::arg("world"), nb::arg("state"), nb::arg("looking"), nb::arg("rows"));
}

}  // namespace irsim
