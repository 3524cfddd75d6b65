// Exponential functions from additions, multiplications and divisions alone, so that IEEE arithmetic gives the same
// bits on every processor, for one number as for a vector of them. Errors are a few units in the last place.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace irsim::networks {

/// exp(x) = scale * (1 + rest): a power of two, and exp(r) - 1 of the remainder |r| <= log(2) / 2.
struct Exponential {
  double scale, rest;
};

/// Needs -708 <= x <= 709.
inline Exponential split_exponential(double x) {
  constexpr double kInverse = 1.44269504088896340736;                                // 1 / log(2)
  constexpr double kHigh = 0.693147180369123816490, kLow = 1.90821492927058770e-10;  // log(2) in two parts
  constexpr double kRound = 6755399441055744.0;                                      // 1.5 * 2^52: adding it rounds
  const double shifted = x * kInverse + kRound, power = shifted - kRound;
  const double r = (x - power * kHigh) - power * kLow;
  double p = 1.0 / 6227020800.0;  // the Taylor series up to r^13
  p = p * r + 1.0 / 479001600.0;
  p = p * r + 1.0 / 39916800.0;
  p = p * r + 1.0 / 3628800.0;
  p = p * r + 1.0 / 362880.0;
  p = p * r + 1.0 / 40320.0;
  p = p * r + 1.0 / 5040.0;
  p = p * r + 1.0 / 720.0;
  p = p * r + 1.0 / 120.0;
  p = p * r + 1.0 / 24.0;
  p = p * r + 1.0 / 6.0;
  p = p * r + 0.5;
  std::uint64_t bits;  // the low bits of `shifted` hold the integer `power`
  std::memcpy(&bits, &shifted, sizeof bits);
  bits = (bits + 1023) << 52;
  double scale;
  std::memcpy(&scale, &bits, sizeof scale);
  return {scale, r + (r * r) * p};
}

inline double clamp(double x, double low, double high) {
  x = x < low ? low : x;
  return x > high ? high : x;
}

/// e^x; 0 below -708, infinite above 709.
inline double exponential(double x) {
  const Exponential e = split_exponential(clamp(x, -708.0, 709.0));
  const double y = e.scale + e.scale * e.rest;
  return x < -708.0 ? 0.0 : x > 709.0 ? std::numeric_limits<double>::infinity() : x == x ? y : x;
}

/// e^x - 1 for x <= 0.
inline double exponential_below_one(double x) {
  const Exponential e = split_exponential(clamp(x, -708.0, 0.0));
  const double y = e.scale * e.rest + (e.scale - 1.0);
  return x == x ? y : x;
}

inline double hyperbolic_tangent(double x) {
  const double e = exponential_below_one(-2.0 * std::fabs(x));
  return std::copysign(-e / (e + 2.0), x);
}

inline double logistic(double x) { return 1.0 / (1.0 + exponential(-x)); }

/// The error function by its series of positive terms, erf x = 2/sqrt(pi) exp(-x^2) sum 2^n x^(2n+1) / (2n+1)!!.
inline double error_function(double x) {
  const double a = std::fabs(x);
  if (!(a < 6.0)) return x == x ? std::copysign(1.0, x) : x;
  double term = a, sum = a;
  for (int n = 1; term > 1e-17 * sum; ++n) {
    term *= 2.0 * a * a / (2 * n + 1);
    sum += term;
  }
  return std::copysign(1.12837916709551257390 * exponential(-a * a) * sum, x);
}

}  // namespace irsim::networks
