// Layers of neural networks in a fixed order of operations: a row has the same result alone and among any others.
#pragma once

#include <cstddef>
#include <cstdint>

namespace irsim::networks {

enum class Function { relu, tanh, sigmoid, elu, gelu, gelu_tanh, silu, exp, sin, cos };
constexpr const char* kFunctionNames[] = {"relu",      "tanh", "sigmoid", "elu", "gelu",
                                          "gelu_tanh", "silu", "exp",     "sin", "cos"};

/// y = x w + b: `rows` rows of `inputs` numbers, `w` of `inputs` rows of `outputs` numbers. Each output starts at its
/// bias and adds the products in the order of the inputs.
template <class Real>
void dense(const Real* x, const Real* w, const Real* b, Real* y, std::size_t rows, std::size_t inputs,
           std::size_t outputs);

/// y = f(x), computed in double precision.
template <class Real>
void apply(Function f, const Real* x, Real* y, std::size_t count);

/// Rows of mean 0 and variance 1: y = (x - mean) / sqrt(variance + epsilon).
template <class Real>
void normalize(const Real* x, Real* y, std::size_t rows, std::size_t columns, double epsilon);

/// exp(x) / sum exp(x) over the columns that are present; 0 elsewhere, and in rows where none is. `mask` may be null.
template <class Real>
void softmax(const Real* x, const std::uint8_t* mask, Real* y, std::size_t rows, std::size_t columns);

/// Sizes of an attention over K keys: `queries` rows of heads * width numbers, values of heads * depth numbers.
struct AttentionSize {
  std::size_t batch, queries, keys, heads, width, depth;
};

/// Scaled dot-product attention over the keys that are present; zeros where none is.
template <class Real>
void attention(const Real* query, const Real* key, const Real* value, const std::uint8_t* mask, Real* y,
               const AttentionSize& size);

}  // namespace irsim::networks
