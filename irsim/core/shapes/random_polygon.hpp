// A star-shaped polygon, or the open polyline through its vertices, drawn for each scene.
#pragma once

#include "fields.hpp"
#include "geometry/shapes.hpp"

namespace irsim {

struct RandomPolygon {
  std::array<double, 4> center_range;      // xmin, ymin, xmax, ymax of the centre, body frame [m]
  std::array<double, 2> avg_radius_range;  // [m]
  std::array<double, 2> irregularity_range, spikeyness_range;
  std::array<int, 2> num_vertices_range;  // upper end excluded
  bool closed;
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using P = RandomPolygon;
    return visit(field("center_range", &P::center_range), field("avg_radius_range", &P::avg_radius_range),
                 field("irregularity_range", &P::irregularity_range), field("spikeyness_range", &P::spikeyness_range),
                 field("num_vertices_range", &P::num_vertices_range), field("closed", &P::closed));
  }
};

constexpr bool is_drawn(const RandomPolygon&) { return true; }

/// Angular steps between n vertices, which sum to a full turn. They are drawn again if one is half a turn or more, with
/// which the polygon could cross itself.
inline std::vector<double> angular_steps(int n, double irregularity, const Draws& draws, std::uint64_t& next) {
  std::vector<double> steps(n, kTurn / n);
  for (int attempt = 0; attempt < 100; ++attempt) {
    std::vector<double> drawn(n);
    double sum = 0.0, largest = 0.0;
    for (double& step : drawn) {
      step = draws.uniform(next++, (1.0 - irregularity) * kTurn / n, (1.0 + irregularity) * kTurn / n);
      sum += step;
    }
    for (double& step : drawn) largest = std::max(largest, step *= kTurn / sum);
    if (largest < kPi || (n == 3 && largest < kTurn)) return drawn;
  }
  return steps;
}

inline Outline outline(const RandomPolygon& p, const Draws& draws, std::uint64_t first) {
  std::uint64_t next = first;
  const auto between = [&](double low, double high) { return draws.uniform(next++, low, high); };
  const double x = between(p.center_range[0], p.center_range[2]), y = between(p.center_range[1], p.center_range[3]);
  const double mean = between(p.avg_radius_range[0], p.avg_radius_range[1]);
  const double irregularity = between(p.irregularity_range[0], p.irregularity_range[1]);
  const double spikeyness = between(p.spikeyness_range[0], p.spikeyness_range[1]);
  const int low = p.num_vertices_range[0], span = std::max(1, p.num_vertices_range[1] - low);
  const int n = std::max(3, low + static_cast<int>(draws.uniform(next++) * span));
  const std::vector<double> steps = angular_steps(n, irregularity, draws, next);
  double angle = between(0.0, kTurn);
  Outline out{p.closed ? Kind::polygon : Kind::linestring, {}};
  for (int i = 0; i < n; ++i) {
    // Normals have their own range of draws. The lower bound keeps spikes from meeting in the centre.
    const double drawn = mean + spikeyness * mean * draws.normal(first + (std::uint64_t{1} << 31) + i);
    const double radius = clip(drawn, 1e-3 * mean, 2.0 * mean);
    out.vertices.push_back({x + radius * std::cos(angle), y + radius * std::sin(angle)});
    angle += steps[i];
  }
  return out;
}

}  // namespace irsim
