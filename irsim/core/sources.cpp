#include "sources.hpp"

#include "sources_digest.hpp"  // generated

namespace irsim {

const char* sources() { return IRSIM_SOURCES; }

}  // namespace irsim
