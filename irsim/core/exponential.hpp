// Linear equations of two unknowns, solved exactly.
#pragma once

#include <algorithm>
#include <cmath>

namespace irsim {

/// A 2x2 matrix.
struct Matrix2 {
  double a, b, c, d;  // row by row
  Matrix2 operator*(const Matrix2& m) const {
    return {a * m.a + b * m.c, a * m.b + b * m.d, c * m.a + d * m.c, c * m.b + d * m.d};
  }
  Matrix2 operator+(const Matrix2& m) const { return {a + m.a, b + m.b, c + m.c, d + m.d}; }
  Matrix2 operator*(double s) const { return {a * s, b * s, c * s, d * s}; }
};

/// Solve y' = A y + f for a time, with constant A and f.
///
/// The exponential e^(At) and the integral of it come from their series for a small part of the time, which is doubled
/// until it is whole. So stiff equations need no small steps, and a singular A no case of its own.
///
/// Args:
///   y: Two values, which are advanced.
inline void advance_linear(const Matrix2& rates, const double (&f)[2], double time, double (&y)[2]) {
  constexpr Matrix2 kOne{1.0, 0.0, 0.0, 1.0};
  const double size = time * std::max(std::fabs(rates.a) + std::fabs(rates.b), std::fabs(rates.c) + std::fabs(rates.d));
  int doublings = 0;
  double part = time;
  for (double left = size; left > 0.25 && doublings < 60; left *= 0.5) part *= 0.5, ++doublings;
  const Matrix2 m = rates * part;
  Matrix2 power = kOne, exponential = kOne, integral = kOne;  // the integral is divided by the part
  double factorial = 1.0;
  for (int k = 1; k <= 10; ++k) {
    power = power * m, factorial *= k;
    exponential = exponential + power * (1.0 / factorial);
    integral = integral + power * (1.0 / (factorial * (k + 1)));
  }
  for (int k = 0; k < doublings; ++k) {
    integral = (exponential + kOne) * integral * 0.5;
    exponential = exponential * exponential;
  }
  const double u = y[0], v = y[1];
  y[0] = exponential.a * u + exponential.b * v + time * (integral.a * f[0] + integral.b * f[1]);
  y[1] = exponential.c * u + exponential.d * v + time * (integral.c * f[0] + integral.d * f[1]);
}

}  // namespace irsim
