// Observation parts of rows of a state, written into arrays of single precision.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "parts.gen.hpp"
#include "surroundings/observe.hpp"

namespace irsim {

/// A part and the column of the observation at which its numbers begin.
using PartAtColumn = std::pair<ObservationPart, std::size_t>;

/// Number of numbers of a part.
std::size_t numbers_of(const ObservationPart& part);

/// Writes what rows observe, one after the other; each thread needs one of its own.
class PartWriter {
 public:
  PartWriter(const World& world, const State& state, const Looking& looking, const std::vector<PartAtColumn>& parts);

  /// Write the parts of a row from `out` on, each from its column. An absent row sees nothing: zeros.
  void write(int row, float* out);

 private:
  const State& state_;
  const Observer observer_;
  const std::vector<PartAtColumn>& parts_;
  Near near_;
  std::vector<double> numbers_;
  std::vector<std::uint8_t> mask_;
};

}  // namespace irsim
