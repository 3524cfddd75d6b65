#include "runs/fetch_ahead.hpp"

#include <algorithm>

namespace irsim {
namespace {

constexpr std::size_t kLine = 64;    // bytes that a processor fetches at once
constexpr std::size_t kMost = 1024;  // bytes of an array that are fetched; the processor foresees the rest itself

void fetch(const void* memory, std::size_t bytes) {
#if defined(__GNUC__)
  const auto* first = static_cast<const char*>(memory);
  for (std::size_t at = 0; at < std::min(bytes, kMost); at += kLine) __builtin_prefetch(first + at);
#else
  (void)memory, (void)bytes;
#endif
}

template <class T>
void fetch(const std::vector<T>& array) {
  fetch(array.data(), array.size() * sizeof(T));
}

void fetch(const Outlines& outlines) {
  fetch(outlines.vertices);
  fetch(outlines.part_boxes);
  fetch(outlines.boxes);
  fetch(outlines.centres);
}

}  // namespace

void fetch_ahead(const State& state, int w, int last) {
  if (w + 3 < last) fetch(&state.scenes[w + 3], sizeof(Scene));
  if (w + 2 < last) {
    const Scene& scene = state.scenes[w + 2];
    fetch(scene.shapes.get(), sizeof(Shapes));
    fetch(scene.fixed.get(), sizeof(Fixed));
  }
  if (w + 1 < last) {
    const Scene& scene = state.scenes[w + 1];
    fetch(scene.moving);
    if (const Shapes* shapes = scene.shapes.get()) {
      fetch(shapes->body);
      fetch(shapes->parts);
      fetch(shapes->vertices);
      fetch(shapes->centre);
      fetch(shapes->radius);
      fetch(shapes->placed);
    }
    if (const Fixed* fixed = scene.fixed.get()) {
      fetch(fixed->outlines);
      fixed->grid.fetch([](const auto& array) { fetch(array); });
    }
  }
}

}  // namespace irsim
