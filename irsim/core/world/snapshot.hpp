// A state as bytes, from which a state of an equal world goes on bit for bit.
#pragma once

#include <vector>

#include "world/state.hpp"

namespace irsim {

/// The state as bytes of this build: everything that a later step, reset or question can depend on. Scratch memory,
/// threads and the record are left out, and geometry that follows from shapes and poses.
std::vector<char> save(State& state);

/// Continue from bytes that `save` made of a state of an equal world.
///
/// Throws std::invalid_argument if the bytes are of another world, or damaged; the state is then not usable.
void load(const World& world, State& state, const char* bytes, std::size_t size);

}  // namespace irsim
