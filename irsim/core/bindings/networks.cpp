// Layers of neural networks over arrays of float or double.
#include "bindings/helpers.hpp"
#include "networks/layers.hpp"

namespace irsim {
namespace {

template <class T, int N>
using In = nb::ndarray<const T, nb::ndim<N>, nb::c_contig, nb::device::cpu>;
using MemberMask = std::optional<In<std::uint8_t, 2>>;

void expect(bool fits, const char* what) {
  if (!fits) throw nb::value_error(what);
}

const std::uint8_t* memory(const MemberMask& mask, std::size_t rows, std::size_t columns) {
  if (!mask) return nullptr;
  expect(mask->shape(0) == rows && mask->shape(1) == columns, "the mask has another shape");
  return mask->data();
}

template <class Real>
nb::object dense(const In<Real, 2>& x, const In<Real, 2>& w, const In<Real, 1>& b) {
  const std::size_t rows = x.shape(0), inputs = x.shape(1), outputs = w.shape(1);
  expect(w.shape(0) == inputs && b.shape(0) == outputs, "x (B, I), w (I, O) and b (O,) do not fit");
  std::vector<Real> y(rows * outputs);
  {
    nb::gil_scoped_release free;
    networks::dense(x.data(), w.data(), b.data(), y.data(), rows, inputs, outputs);
  }
  return own(std::move(y), {rows, outputs});
}

template <class Real>
nb::object elementwise(const std::string& name, const In<Real, 1>& x) {
  int found = -1;
  for (int i = 0; i < static_cast<int>(std::size(networks::kFunctionNames)); ++i)
    if (name == networks::kFunctionNames[i]) found = i;
  expect(found >= 0, "there is no function of that name");
  std::vector<Real> y(x.shape(0));
  {
    nb::gil_scoped_release free;
    networks::apply(static_cast<networks::Function>(found), x.data(), y.data(), y.size());
  }
  const std::size_t count = y.size();
  return own(std::move(y), {count});
}

template <class Real>
nb::object normalize(const In<Real, 2>& x, double epsilon) {
  const std::size_t rows = x.shape(0), columns = x.shape(1);
  std::vector<Real> y(rows * columns);
  networks::normalize(x.data(), y.data(), rows, columns, epsilon);
  return own(std::move(y), {rows, columns});
}

template <class Real>
nb::object softmax(const In<Real, 2>& x, const MemberMask& mask) {
  const std::size_t rows = x.shape(0), columns = x.shape(1);
  std::vector<Real> y(rows * columns);
  networks::softmax(x.data(), memory(mask, rows, columns), y.data(), rows, columns);
  return own(std::move(y), {rows, columns});
}

template <class Real>
nb::object attention(const In<Real, 3>& query, const In<Real, 3>& key, const In<Real, 3>& value, const MemberMask& mask,
                     std::size_t heads) {
  const std::size_t batch = query.shape(0), queries = query.shape(1), keys = key.shape(1);
  expect(heads > 0 && query.shape(2) % heads == 0 && value.shape(2) % heads == 0, "the heads do not divide the width");
  expect(key.shape(0) == batch && value.shape(0) == batch && value.shape(1) == keys && key.shape(2) == query.shape(2),
         "query (B, Q, D), key (B, K, D) and value (B, K, V) do not fit");
  const networks::AttentionSize size{batch, queries, keys, heads, query.shape(2) / heads, value.shape(2) / heads};
  std::vector<Real> y(batch * queries * value.shape(2));
  {
    nb::gil_scoped_release free;
    networks::attention(query.data(), key.data(), value.data(), memory(mask, batch, keys), y.data(), size);
  }
  return own(std::move(y), {batch, queries, value.shape(2)});
}

template <class Real>
void bind_layers(nb::module_& m) {
  m.def("dense", &dense<Real>, nb::arg("x").noconvert(), nb::arg("w").noconvert(), nb::arg("b").noconvert());
  m.def("elementwise", &elementwise<Real>, nb::arg("name"), nb::arg("x").noconvert());
  m.def("normalize", &normalize<Real>, nb::arg("x").noconvert(), nb::arg("epsilon"));
  m.def("softmax", &softmax<Real>, nb::arg("x").noconvert(), nb::arg("mask") = nb::none());
  m.def("attention", &attention<Real>, nb::arg("query").noconvert(), nb::arg("key").noconvert(),
        nb::arg("value").noconvert(), nb::arg("mask") = nb::none(), nb::arg("heads") = 1);
}

}  // namespace

void bind_networks(nb::module_& m) {
  bind_layers<float>(m);
  bind_layers<double>(m);
}

}  // namespace irsim
