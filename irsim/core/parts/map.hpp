// A square picture of the static objects around the robot.
#pragma once

#include "fields.hpp"
#include "observing.hpp"

namespace irsim {

struct MapOptions {
  int cells;    // along a side
  double size;  // length of a side [m]
  Frame frame;
  bool outside_occupied;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using O = MapOptions;
    return visit(field("cells", &O::cells), field("size", &O::size), choice("frame", &O::frame, "own", "goal", "world"),
                 field("outside_occupied", &O::outside_occupied));
  }
};

inline std::size_t members(const MapOptions&) { return 0; }
inline std::size_t width(const MapOptions& o) { return static_cast<std::size_t>(o.cells) * o.cells; }

inline bool is_occupied(const Picture& picture, Vec2 at, bool outside) {
  const double i = std::floor((at.x - picture.origin.x) / picture.resolution);
  const double j = std::floor((at.y - picture.origin.y) / picture.resolution);
  if (!(i >= 0.0 && i < static_cast<double>(picture.nx) && j >= 0.0 && j < static_cast<double>(picture.ny)))
    return outside;
  return picture.occupied[static_cast<std::size_t>(i) * picture.ny + static_cast<std::size_t>(j)] != 0;
}

/// A cell is occupied if one of its samples is. Neighboring samples are at most resolution / sqrt(2) apart, so that
/// they hit every cell of the map, but there are no more than `kMostSamples` along a side.
inline void map(const MapOptions& o, const Seen& seen, double* out, std::uint8_t*) {
  constexpr double kMostSamples = 32.0;
  const Picture& picture = *seen.picture;
  const Vec2 axis = x_axis(o.frame, seen), centre = seen.pose.position();
  const double wanted = std::ceil(std::sqrt(2.0) * (o.size / o.cells) / picture.resolution);
  const int samples = static_cast<int>(std::min(wanted, kMostSamples)), count = o.cells * samples;
  const auto offset = [&](int k) { return (k + 0.5) * (o.size / count) - o.size / 2.0; };
  std::fill(out, out + width(o), 0.0);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      double& cell = out[(i / samples) * o.cells + j / samples];
      if (cell == 0.0 && is_occupied(picture, centre + rotate({offset(i), offset(j)}, axis), o.outside_occupied))
        cell = 1.0;
    }
  }
}

}  // namespace irsim
