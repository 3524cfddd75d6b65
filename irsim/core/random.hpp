// Counter-based random numbers: a draw is a pure function of (seed, scene, noise, stream, object, draw).
//
// Philox4x64-10 after Salmon, Moraes, Dror, Shaw: Parallel Random Numbers: As Easy as 1, 2, 3 (SC 2011).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "geometry/vec.hpp"
#ifdef _MSC_VER
#include <intrin.h>
#endif

namespace irsim {

enum class Stream : std::uint64_t {
  placement,
  shape,
  goal,
  motion,
  sensor,
  behavior,
  planner,
  map,
  user,
  perturbation,
  policy,
  task,
  actuation,
  slip
};
constexpr std::array<const char*, 14> kStreamNames = {"placement", "shape",   "goal",      "motion", "sensor",
                                                      "behavior",  "planner", "map",       "user",   "perturbation",
                                                      "policy",    "task",    "actuation", "slip"};

/// The stream of sensor number `index` of an object.
inline std::uint64_t sensor_stream(int index) {
  return static_cast<std::uint64_t>(Stream::sensor) + 16 * static_cast<std::uint64_t>(index);
}

struct Key {
  std::uint64_t seed = 0, episode = 0;
};
inline Key make_key(std::uint64_t seed, std::uint32_t scene, std::uint32_t noise) {
  return {seed, (static_cast<std::uint64_t>(scene) << 32) | noise};
}

using Block = std::array<std::uint64_t, 4>;

inline std::uint64_t multiply(std::uint64_t a, std::uint64_t b, std::uint64_t& high) {
#if defined(_MSC_VER) && defined(_M_X64)
  return _umul128(a, b, &high);
#elif defined(_MSC_VER)
  high = __umulh(a, b);
  return a * b;
#else
  __extension__ using Wide = unsigned __int128;
  const Wide product = static_cast<Wide>(a) * b;
  high = static_cast<std::uint64_t>(product >> 64);
  return static_cast<std::uint64_t>(product);
#endif
}

/// The block of a key and a counter. numpy.random.Philox yields the same words but increments its counter first.
inline Block philox(Key key, Block counter) {
  for (int round = 0; round < 10; ++round) {
    std::uint64_t high0, high1;
    const std::uint64_t low0 = multiply(0xD2E7470EE14C6C93u, counter[0], high0);
    const std::uint64_t low1 = multiply(0xCA5A826395121157u, counter[2], high1);
    counter = {high1 ^ counter[1] ^ key.seed, low1, high0 ^ counter[3] ^ key.episode, low0};
    key.seed += 0x9E3779B97F4A7C15u;
    key.episode += 0xBB67AE8584CAA73Bu;
  }
  return counter;
}

/// The draws of one object in one stream. Each kind of draw is numbered separately; draw d is in block d / 4. Kinds
/// that came later have a lane of their own, so that the numbers of the others stay what they are.
struct Draws {
  Key key;
  std::uint64_t stream, object, lane;

  Draws(Key k, std::uint64_t s, int i, std::uint64_t l = 0)
      : key(k), stream(s), object(static_cast<std::uint64_t>(i)), lane(l) {}
  Draws(Key k, Stream s, int i) : Draws(k, static_cast<std::uint64_t>(s), i) {}

  Block block(std::uint64_t index) const { return philox(key, {index, object, stream, lane}); }

  /// Uniform in [0, 1).
  double uniform(std::uint64_t draw) const { return fraction(block(draw / 4)[draw % 4]); }
  double uniform(std::uint64_t draw, double low, double high) const { return low + (high - low) * uniform(draw); }

  std::array<double, 4> uniforms(std::uint64_t index) const {
    const Block b = block(index);
    return {fraction(b[0]), fraction(b[1]), fraction(b[2]), fraction(b[3])};
  }

  /// Standard normal (Box-Muller, two draws per pair of words).
  double normal(std::uint64_t draw) const { return normals(draw / 4)[draw % 4]; }
  std::array<double, 4> normals(std::uint64_t index) const {
    const Block b = block(index);
    std::array<double, 4> out;
    for (int i = 0; i < 4; i += 2) {
      const double length = std::sqrt(-2.0 * std::log(1.0 - fraction(b[i])));
      const double angle = kTurn * fraction(b[i + 1]);
      out[i] = length * std::cos(angle);
      out[i + 1] = length * std::sin(angle);
    }
    return out;
  }

  /// A word as a number in [0, 1).
  static double fraction(std::uint64_t word) { return static_cast<double>(word >> 11) * 0x1.0p-53; }
};

/// Draws taken mostly in order: each block is computed once.
template <std::array<double, 4> (Draws::*Make)(std::uint64_t) const>
class InOrder {
 public:
  explicit InOrder(const Draws& draws) : draws_(draws) {}
  double operator()(std::uint64_t draw) {
    if (draw / 4 != index_) {
      index_ = draw / 4;
      block_ = (draws_.*Make)(index_);
    }
    return block_[draw % 4];
  }

 private:
  Draws draws_;
  std::uint64_t index_ = ~std::uint64_t{0};
  std::array<double, 4> block_{};
};

using NormalDraws = InOrder<&Draws::normals>;
using UniformDraws = InOrder<&Draws::uniforms>;

}  // namespace irsim
