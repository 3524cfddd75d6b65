// Maps of gradient noise.
//
// Perlin: Improving Noise, SIGGRAPH 2002, in two dimensions with eight gradients.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "random.hpp"

namespace irsim {

struct PerlinNoise {
  int columns, rows;
  double complexity;   // frequency of the first octave [1/cell]
  double fill;         // share of occupied cells
  int fractal;         // octaves, each of twice the frequency
  double attenuation;  // octave k has the amplitude attenuation / (k + 1)
};

using Permutation = std::array<std::uint8_t, 256>;

/// A permutation drawn from a stream.
Permutation draw_permutation(const Draws& draws);
/// (columns * rows,) 1 where occupied, row by row from the lowest. The share `fill` of cells with the highest noise is
/// occupied.
std::vector<std::uint8_t> perlin_cells(const PerlinNoise& noise, const Permutation& permutation);

}  // namespace irsim
