// A block of memory that NumPy arrays can view and keep alive.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>

namespace irsim {

template <class T>
struct Array {
  std::shared_ptr<T> memory;
  T* data = nullptr;
  std::size_t size = 0;

  Array() = default;
  explicit Array(std::size_t n, T value = T{}) : memory(new T[n > 0 ? n : 1], std::default_delete<T[]>()), size(n) {
    data = memory.get();
    std::fill(data, data + n, value);
  }
  T& operator[](std::size_t i) { return data[i]; }
  const T& operator[](std::size_t i) const { return data[i]; }
};

}  // namespace irsim
