// Powers for lidars, which need one for many a beam.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace irsim {

/// base^exponent of a base >= 0 and an exponent from 0 to 2, with a relative error below 2e-8; 2^-1000 if it is less.
///
/// The logarithm of base 2 is the exponent of the number plus the series of 2 artanh((m - 1) / (m + 1)) for its
/// mantissa m between sqrt(1/2) and sqrt(2); the power of 2 is a whole one times the exponential series of what is
/// left. Terms left out are below 2e-9 and 6e-9.
inline double quick_power(double base, double exponent) {
  constexpr double kWhole = 0x1.8p52;  // a double of this size has no digits after the point
  constexpr double kLog2 = 0.69314718055994531;
  constexpr std::int64_t kHalfRoot = 0x3FE6A09E667F3BCD;  // the bits of sqrt(1/2)
  std::int64_t bits;
  std::memcpy(&bits, &base, sizeof bits);
  const std::int64_t doublings = (bits - kHalfRoot) >> 52;
  bits -= static_cast<std::int64_t>(static_cast<std::uint64_t>(doublings) << 52);
  double m;
  std::memcpy(&m, &bits, sizeof m);
  const double t = (m - 1.0) / (m + 1.0), s = t * t;
  const double series = t * (2.0 + s * (2.0 / 3.0 + s * (2.0 / 5.0 + s * (2.0 / 7.0 + s * (2.0 / 9.0)))));
  const double log2 = static_cast<double>(doublings) + series * (1.0 / kLog2);
  const double power = std::max(exponent * log2, -1000.0), whole = power + kWhole - kWhole, f = (power - whole) * kLog2;
  const double low = 1.0 + f * (1.0 + f * (1.0 / 2.0 + f * (1.0 / 6.0)));
  const double high = 1.0 / 24.0 + f * (1.0 / 120.0 + f * (1.0 / 720.0 + f * (1.0 / 5040.0)));
  double out = low + f * f * (f * f) * high;
  std::memcpy(&bits, &out, sizeof bits);
  bits += static_cast<std::int64_t>(whole) * (std::int64_t{1} << 52);
  std::memcpy(&out, &bits, sizeof out);
  return out;
}

}  // namespace irsim
