// Small functions for the Python API and for tests.
#include "bindings/helpers.hpp"
#include "collision/distance.hpp"
#include "collision/touch.hpp"
#include "orca/half_planes.hpp"
#include "orca/nearest.hpp"
#include "random.hpp"
#include "world/spec.hpp"

namespace irsim {
namespace {

using PoseNumbers = std::array<double, 3>;

using Parts = std::vector<PartSpec>;

/// Two bodies, each at a pose.
class Pair {
 public:
  Pair(const Parts& parts_a, const PoseNumbers& a, const Parts& parts_b, const PoseNumbers& b) {
    for (const auto* parts : {&parts_a, &parts_b}) {
      shapes_.add(draw_outlines(*parts, Draws({}, Stream::shape, 0)), false);
    }
    outlines_.resize(shapes_.size[0]);
    outlines_.place(shapes_, 0, {a[0], a[1], a[2]}, unit(a[2]));
    outlines_.place(shapes_, 1, {b[0], b[1], b[2]}, unit(b[2]));
  }

  Footprint operator[](int body) const { return outlines_.footprint(shapes_, body); }

 private:
  Shapes shapes_;
  Outlines outlines_;
};

bool intersects(const Parts& parts_a, const PoseNumbers& a, const Parts& parts_b, const PoseNumbers& b) {
  const Pair both(parts_a, a, parts_b, b);
  return touch(both[0], both[1]);
}

double distance_between(const Parts& parts_a, const PoseNumbers& a, const Parts& parts_b, const PoseNumbers& b) {
  const Pair both(parts_a, a, parts_b, b);
  return distance(both[0], both[1]);
}

std::tuple<double, double, bool> best_velocity(const std::vector<std::array<double, 4>>& lines, int hard,
                                               double max_speed, std::pair<double, double> preferred) {
  std::vector<HalfPlane> planes, scratch;
  for (const auto& line : lines) planes.push_back({{line[0], line[1]}, {line[2], line[3]}});
  Vec2 v;
  const bool free = choose_velocity(planes.data(), static_cast<int>(planes.size()), hard, max_speed,
                                    {preferred.first, preferred.second}, scratch, v);
  return {v.x, v.y, free};
}

std::vector<int> nearest_points(const std::vector<std::pair<double, double>>& points, std::pair<double, double> centre,
                                std::pair<double, double> ahead, double reach, int most) {
  Nearest all;
  for (const auto& [x, y] : points) all.add({x, y});
  all.build();
  std::vector<Nearest::Found> found(static_cast<std::size_t>(std::max(most, 0)));
  const auto any = [](int) { return true; };
  const int count =
      all.find({centre.first, centre.second}, {ahead.first, ahead.second}, reach, most, {}, any, found.data());
  std::vector<int> out;
  for (int k = 0; k < count; ++k) out.push_back(found[k].index);
  return out;
}

}  // namespace

void bind_tools(nb::module_& m) {
  m.def("intersects", &intersects, nb::arg("parts_a"), nb::arg("pose_a"), nb::arg("parts_b"), nb::arg("pose_b"));
  m.def("distance", &distance_between, nb::arg("parts_a"), nb::arg("pose_a"), nb::arg("parts_b"), nb::arg("pose_b"));
  m.def("best_velocity", &best_velocity, nb::arg("planes"), nb::arg("hard"), nb::arg("max_speed"),
        nb::arg("preferred"));
  m.def("nearest_points", &nearest_points, nb::arg("points"), nb::arg("centre"), nb::arg("ahead"), nb::arg("reach"),
        nb::arg("most"));
  m.def(
      "random_bits",
      [](std::uint64_t seed, std::uint32_t scene, std::uint32_t noise, std::uint64_t stream, std::uint64_t object,
         std::uint64_t draw) {
        const Block b = philox(make_key(seed, scene, noise), {draw, object, stream, 0});
        return std::make_tuple(b[0], b[1], b[2], b[3]);
      },
      nb::arg("seed"), nb::arg("scene"), nb::arg("noise"), nb::arg("stream"), nb::arg("object"), nb::arg("draw"));
  nb::dict streams;
  for (std::size_t i = 0; i < kStreamNames.size(); ++i) streams[kStreamNames[i]] = i;
  m.attr("STREAMS") = streams;
}

}  // namespace irsim
