// Names the sources that this core was compiled from.
#pragma once

namespace irsim {

// SHA-256 of all sources of the core, in hexadecimal; cmake/digest.cmake computes it in each build.
const char* sources();

}  // namespace irsim
