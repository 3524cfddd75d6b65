#include "maps/perlin.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace irsim {
namespace {

constexpr double kHalf = 0.70710678118654752440;
constexpr double kGradients[8][2] = {{1, 0},         {-1, 0},         {0, 1},          {0, -1},
                                     {kHalf, kHalf}, {-kHalf, kHalf}, {kHalf, -kHalf}, {-kHalf, -kHalf}};

double fade(double t) { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); }
double blend(double a, double b, double t) { return a + t * (b - a); }

/// The position of a coordinate in the lattice of the noise.
struct Place {
  int low, high;      // indices of the permutation below and above
  double part, fade;  // offset from the lattice line below, and its smoothed value
};

std::vector<Place> places(int count, double frequency) {
  std::vector<Place> out(count);
  for (int i = 0; i < count; ++i) {
    const double at = i * frequency, line = std::floor(at);
    const int low = static_cast<int>(static_cast<std::int64_t>(line) & 255);
    out[i] = {low, (low + 1) & 255, at - line, fade(at - line)};
  }
  return out;
}

}  // namespace

Permutation draw_permutation(const Draws& draws) {
  Permutation p;
  std::iota(p.begin(), p.end(), std::uint8_t{0});
  for (int i = 255; i > 0; --i) {
    std::swap(p[i], p[static_cast<int>(draws.uniform(static_cast<std::uint64_t>(i)) * (i + 1))]);
  }
  return p;
}

std::vector<std::uint8_t> perlin_cells(const PerlinNoise& noise, const Permutation& permutation) {
  const int columns = noise.columns, rows = noise.rows;
  const std::size_t cells = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  std::vector<double> value(cells, 0.0);
  double total = 0.0;
  for (int octave = 0; octave < noise.fractal; ++octave) {
    const double frequency = noise.complexity * std::ldexp(1.0, octave), amplitude = noise.attenuation / (octave + 1);
    total += amplitude;
    const std::vector<Place> along = places(columns, frequency), up = places(rows, frequency);
    for (int j = 0; j < rows; ++j) {
      const Place& y = up[j];
      for (int i = 0; i < columns; ++i) {
        const Place& x = along[i];
        const auto corner = [&](int px, int py, double dx, double dy) {
          // the gradient has the index perm[perm[x] + y]
          const double* g = kGradients[permutation[(permutation[px] + py) & 255] & 7];
          return g[0] * dx + g[1] * dy;
        };
        const double low =
            blend(corner(x.low, y.low, x.part, y.part), corner(x.high, y.low, x.part - 1.0, y.part), x.fade);
        const double high = blend(corner(x.low, y.high, x.part, y.part - 1.0),
                                  corner(x.high, y.high, x.part - 1.0, y.part - 1.0), x.fade);
        value[static_cast<std::size_t>(j) * columns + i] += amplitude * blend(low, high, y.fade);
      }
    }
  }
  for (double& v : value) v = clip((v / total + 1.0) / 2.0, 0.0, 1.0);
  std::vector<double> sorted = value;
  const double rank = (1.0 - noise.fill) * static_cast<double>(cells);
  const std::size_t index = std::min(static_cast<std::size_t>(std::max(rank, 0.0)), cells - 1);
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(index), sorted.end());
  std::vector<std::uint8_t> occupied(cells);
  for (std::size_t k = 0; k < cells; ++k) occupied[k] = value[k] > sorted[index];
  return occupied;
}

}  // namespace irsim
