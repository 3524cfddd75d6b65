#include "networks/layers.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "networks/functions.hpp"

// One kernel for every processor; those with wider registers run a copy compiled for them. As no product is fused with
// a sum and every output has its own order of additions, the width of the registers does not change a bit.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__)
#define IRSIM_WIDE 1
#define IRSIM_INLINE inline __attribute__((always_inline))
#else
#define IRSIM_WIDE 0
#define IRSIM_INLINE inline
#endif

namespace irsim::networks {
namespace {

/// Outputs `from` to `from + Width` of all rows, whose weights fit the nearest cache and whose sums stay in registers.
template <class Real, int Width>
IRSIM_INLINE void dense_block(const Real* x, const Real* w, const Real* b, Real* y, std::size_t rows,
                              std::size_t inputs, std::size_t outputs) {
  for (std::size_t r = 0; r < rows; ++r) {
    Real sum[Width];
    for (int o = 0; o < Width; ++o) sum[o] = b[o];
    for (std::size_t i = 0; i < inputs; ++i) {
      const Real value = x[r * inputs + i];
      const Real* row = w + i * outputs;
      for (int o = 0; o < Width; ++o) sum[o] += value * row[o];
    }
    for (int o = 0; o < Width; ++o) y[r * outputs + o] = sum[o];
  }
}

template <class Real>
IRSIM_INLINE void dense_all(const Real* x, const Real* w, const Real* b, Real* y, std::size_t rows, std::size_t inputs,
                            std::size_t outputs) {
  constexpr int kWide = 32, kNarrow = 8;
  std::size_t o = 0;
  for (; o + kWide <= outputs; o += kWide) dense_block<Real, kWide>(x, w + o, b + o, y + o, rows, inputs, outputs);
  for (; o + kNarrow <= outputs; o += kNarrow)
    dense_block<Real, kNarrow>(x, w + o, b + o, y + o, rows, inputs, outputs);
  for (; o < outputs; ++o) dense_block<Real, 1>(x, w + o, b + o, y + o, rows, inputs, outputs);
}

#if IRSIM_WIDE
template <class Real>
__attribute__((target("avx2"))) void dense_wide(const Real* x, const Real* w, const Real* b, Real* y, std::size_t rows,
                                                std::size_t inputs, std::size_t outputs) {
  dense_all(x, w, b, y, rows, inputs, outputs);
}
#endif

template <class Real, class F>
void each(const Real* x, Real* y, std::size_t count, F f) {
  for (std::size_t i = 0; i < count; ++i) y[i] = static_cast<Real>(f(static_cast<double>(x[i])));
}

double gelu_by_tanh(double x) {
  return 0.5 * x * (1.0 + hyperbolic_tangent(0.79788456080286535588 * (x + 0.044715 * x * x * x)));
}

}  // namespace

template <class Real>
void dense(const Real* x, const Real* w, const Real* b, Real* y, std::size_t rows, std::size_t inputs,
           std::size_t outputs) {
#if IRSIM_WIDE
  static const bool wide = __builtin_cpu_supports("avx2");
  if (wide) return dense_wide(x, w, b, y, rows, inputs, outputs);
#endif
  dense_all(x, w, b, y, rows, inputs, outputs);
}

template <class Real>
void apply(Function f, const Real* x, Real* y, std::size_t count) {
  switch (f) {
    case Function::relu:
      return each(x, y, count, [](double v) { return v < 0.0 ? 0.0 : v; });
    case Function::tanh:
      return each(x, y, count, hyperbolic_tangent);
    case Function::sigmoid:
      return each(x, y, count, logistic);
    case Function::elu:
      return each(x, y, count, [](double v) { return v < 0.0 ? exponential_below_one(v) : v; });
    case Function::gelu:
      return each(x, y, count, [](double v) { return 0.5 * v * (1.0 + error_function(v * 0.70710678118654752440)); });
    case Function::gelu_tanh:
      return each(x, y, count, gelu_by_tanh);
    case Function::silu:
      return each(x, y, count, [](double v) { return v * logistic(v); });
    case Function::exp:
      return each(x, y, count, exponential);
    case Function::sin:
      return each(x, y, count, [](double v) { return std::sin(v); });
    case Function::cos:
      return each(x, y, count, [](double v) { return std::cos(v); });
  }
}

template <class Real>
void normalize(const Real* x, Real* y, std::size_t rows, std::size_t columns, double epsilon) {
  for (std::size_t r = 0; r < rows; ++r, x += columns, y += columns) {
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < columns; ++i) sum += x[i];
    const double mean = sum / static_cast<double>(columns);
    for (std::size_t i = 0; i < columns; ++i) squares += (x[i] - mean) * (x[i] - mean);
    const double width = std::sqrt(squares / static_cast<double>(columns) + epsilon);
    for (std::size_t i = 0; i < columns; ++i) y[i] = static_cast<Real>((x[i] - mean) / width);
  }
}

template <class Real>
void softmax(const Real* x, const std::uint8_t* mask, Real* y, std::size_t rows, std::size_t columns) {
  std::vector<double> weight(columns);
  for (std::size_t r = 0; r < rows; ++r, x += columns, y += columns) {
    const auto present = [&](std::size_t i) { return mask == nullptr || mask[r * columns + i] != 0; };
    double largest = -std::numeric_limits<double>::infinity(), sum = 0.0;
    for (std::size_t i = 0; i < columns; ++i)
      if (present(i)) largest = std::max(largest, static_cast<double>(x[i]));
    for (std::size_t i = 0; i < columns; ++i) {
      weight[i] = present(i) ? exponential(x[i] - largest) : 0.0;
      sum += weight[i];
    }
    for (std::size_t i = 0; i < columns; ++i) y[i] = static_cast<Real>(sum > 0.0 ? weight[i] / sum : 0.0);
  }
}

template <class Real>
void attention(const Real* query, const Real* key, const Real* value, const std::uint8_t* mask, Real* y,
               const AttentionSize& n) {
  const double scale = 1.0 / std::sqrt(static_cast<double>(n.width));
  std::vector<double> score(n.keys), weight(n.keys), sum(n.depth);
  for (std::size_t row = 0; row < n.batch * n.queries * n.heads; ++row) {
    const std::size_t head = row % n.heads, world = row / (n.queries * n.heads);
    const Real* q = query + row * n.width;
    const auto first = [&](std::size_t k) { return (world * n.keys + k) * n.heads + head; };
    for (std::size_t k = 0; k < n.keys; ++k) {
      const Real* other = key + first(k) * n.width;
      double product = 0.0;
      for (std::size_t i = 0; i < n.width; ++i) product += static_cast<double>(q[i]) * other[i];
      score[k] = product * scale;
    }
    softmax(score.data(), mask == nullptr ? nullptr : mask + world * n.keys, weight.data(), 1, n.keys);
    std::fill(sum.begin(), sum.end(), 0.0);
    for (std::size_t k = 0; k < n.keys; ++k) {
      const Real* from = value + first(k) * n.depth;
      for (std::size_t i = 0; i < n.depth; ++i) sum[i] += weight[k] * from[i];
    }
    for (std::size_t i = 0; i < n.depth; ++i) y[row * n.depth + i] = static_cast<Real>(sum[i]);
  }
}

#define IRSIM_LAYERS(Real)                                                                                  \
  template void dense(const Real*, const Real*, const Real*, Real*, std::size_t, std::size_t, std::size_t); \
  template void apply(Function, const Real*, Real*, std::size_t);                                           \
  template void normalize(const Real*, Real*, std::size_t, std::size_t, double);                            \
  template void softmax(const Real*, const std::uint8_t*, Real*, std::size_t, std::size_t);                 \
  template void attention(const Real*, const Real*, const Real*, const std::uint8_t*, Real*, const AttentionSize&);
IRSIM_LAYERS(float)
IRSIM_LAYERS(double)
#undef IRSIM_LAYERS

}  // namespace irsim::networks
