// Memory that the steps of the next worlds read.
#pragma once

#include "world/state.hpp"

namespace irsim {

/// Ask the processor for what the steps of worlds w + 1 and later read first, while the step of world w runs. Many
/// worlds are larger than its caches. Each call follows the pointers of one more world as far as they are known by
/// then. Only worlds before `last` are looked at: another thread may be changing the others.
void fetch_ahead(const State& state, int w, int last);

}  // namespace irsim
