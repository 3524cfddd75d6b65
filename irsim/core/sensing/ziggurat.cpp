#include "sensing/ziggurat.hpp"

namespace irsim {
namespace {

constexpr std::uint64_t kLaneStep = std::uint64_t{1} << 32;  // between the lanes of successive attempts

double curve(double x) { return std::exp(-0.5 * x * x); }

}  // namespace

Ziggurat::Ziggurat() {
  const double area = kTail * curve(kTail) + std::sqrt(0.5 * kPi) * std::erfc(kTail / std::sqrt(2.0));
  width[0] = area / curve(kTail), width[1] = kTail;
  for (int i = 2; i < kLayers; ++i) {
    width[i] = std::sqrt(-2.0 * std::log(area / width[i - 1] + curve(width[i - 1])));
  }
  width[kLayers] = 0.0;
  for (int i = 0; i < kLayers; ++i) inner[i] = width[i + 1] / width[i];
}

const Ziggurat& ZigguratDraws::layers() {
  static const Ziggurat kZiggurat;
  return kZiggurat;
}

double ZigguratDraws::at_edge(std::uint64_t draw, std::uint64_t word) const {
  for (Draws more = draws_;;) {
    const double place = place_of(word);
    const std::size_t layer = word % Ziggurat::kLayers;
    const double wide = layers_.width[layer], x = place * wide;
    if (std::fabs(place) < layers_.inner[layer]) return x;
    more.lane += kLaneStep;
    const Block words = more.block(draw);
    const double luck = 1.0 - Draws::fraction(words[0]);
    if (layer > 0) {
      const double low = curve(wide), high = curve(layers_.width[layer + 1]);
      if (low + luck * (high - low) <= curve(x)) return x;
      word = words[1];
    } else {
      // Marsaglia: Generating a Variable from the Tail of the Normal Distribution (Technometrics 6, 1964).
      const double beyond = -std::log(luck) / Ziggurat::kTail;
      if (-2.0 * std::log(1.0 - Draws::fraction(words[1])) >= beyond * beyond) {
        return std::copysign(Ziggurat::kTail + beyond, place);
      }
    }
  }
}

}  // namespace irsim
