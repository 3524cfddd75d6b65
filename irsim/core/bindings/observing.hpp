// Checks of what is observed.
#pragma once

#include "bindings/bound_state.hpp"
#include "learning/write_parts.hpp"
#include "runs/clearances.hpp"

namespace irsim {

inline constexpr const char* kObject = "there must be one entry for each object";

inline void expect_fit(bool fits, const char* what) {
  if (!fits) throw nb::value_error(what);
}

void check_looking(const World& world, const Looking& looking);
void check_parts(const std::vector<PartAtColumn>& parts, std::size_t columns);
/// The kind of each object, as policies see it, from its numbers.
std::vector<ObjectKind> kinds_of(const World& world, const Mask& codes);

}  // namespace irsim
