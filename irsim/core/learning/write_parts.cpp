#include "learning/write_parts.hpp"

#include <algorithm>

#include "world/state.hpp"

namespace irsim {
namespace {

template <class Options>
std::size_t size_of(const Options& options) {
  const std::size_t set = members(options);
  return (set > 0 ? set : 1) * width(options);
}

}  // namespace

std::size_t numbers_of(const ObservationPart& part) {
  std::size_t numbers = 0;
  with(part, [&](const auto& options) { numbers = size_of(options); });
  return numbers;
}

PartWriter::PartWriter(const World& world, const State& state, const Looking& looking,
                       const std::vector<PartAtColumn>& parts)
    : state_(state), observer_(world, state, looking), parts_(parts) {
  for (const auto& [part, column] : parts) {
    with(part, [&](const auto& options) {
      numbers_.resize(std::max(numbers_.size(), size_of(options)));
      mask_.resize(std::max<std::size_t>(mask_.size(), members(options)));
    });
  }
}

void PartWriter::write(int row, float* out) {
  if (state_.absent(row)) {
    for (const auto& [part, column] : parts_) std::fill_n(out + column, numbers_of(part), 0.0F);
    return;
  }
  const Seen seen = observer_.see(row, near_);
  for (const auto& [part, column] : parts_) {
    with(part, [&, column = column](const auto& options) {
      run(options, seen, numbers_.data(), mask_.data());
      std::copy(numbers_.data(), numbers_.data() + size_of(options), out + column);
    });
  }
}

}  // namespace irsim
