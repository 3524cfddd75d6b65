// Standard normal numbers for lidars with errors, which need one for each beam: a word makes a number, mostly by a
// comparison and a multiplication.
//
// Marsaglia, Tsang: The Ziggurat Method for Generating Random Variables (Journal of Statistical Software 5, 2000), with
// 256 layers. Layer and place within it come from different bits, as Doornik: An Improved Ziggurat Method to Generate
// Normal Random Samples (2005) asks for. The distribution is exact.
#pragma once

#include "random.hpp"

namespace irsim {

/// Layers of equal area that cover the curve exp(-x^2 / 2) of x >= 0. Layer 0 has the tail beneath it, too.
struct Ziggurat {
  static constexpr int kLayers = 256;
  static constexpr double kTail = 3.6541528853610088;  // where the tail begins, for this number of layers

  Ziggurat();

  double width[kLayers + 1];  // from the lowest layer up; 0 at the top of the last one
  double inner[kLayers];      // share of the width that lies below the curve over the whole height of the layer
};

/// Draws of standard normal numbers, taken mostly in order. Draw d has the word of uniform draw d. The one in 80 for
/// which a word is not enough takes more of them from lanes of its own, so that it, too, depends on nothing else.
class ZigguratDraws {
 public:
  explicit ZigguratDraws(const Draws& draws) : draws_(draws), layers_(layers()) {}

  double operator()(std::uint64_t draw) {
    if (draw / 4 != index_) index_ = draw / 4, block_ = draws_.block(index_);
    const std::uint64_t word = block_[draw % 4];
    const double place = place_of(word);
    const std::size_t layer = word % Ziggurat::kLayers;
    return std::fabs(place) < layers_.inner[layer] ? place * layers_.width[layer] : at_edge(draw, word);
  }

 private:
  /// Uniform in [-1, 1), from other bits than the layer.
  static double place_of(std::uint64_t word) {
    return static_cast<double>(static_cast<std::int64_t>(word) >> 11) * 0x1.0p-52;
  }
  static const Ziggurat& layers();
  double at_edge(std::uint64_t draw, std::uint64_t word) const;

  Draws draws_;
  const Ziggurat& layers_;
  std::uint64_t index_ = ~std::uint64_t{0};
  Block block_{};
};

}  // namespace irsim
