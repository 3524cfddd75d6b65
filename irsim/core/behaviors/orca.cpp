#include "behaviors/orca.hpp"

#include "orca/avoidance.hpp"

namespace irsim {

void orca(const OrcaOptions& options, const Decision& decision, Intent* intents) {
  avoid(options, decision, nullptr, intents);
}

}  // namespace irsim
