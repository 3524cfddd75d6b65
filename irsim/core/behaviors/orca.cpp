#include "behaviors/orca.hpp"

#include "orca/avoidance.hpp"

namespace irsim {

void orca(const OrcaOptions& options, const Decision& decision, Intent* intents) {
  OrcaSettings settings = settings_of(options);
  settings.responsibility = options.responsibility;
  avoid(settings, decision, nullptr, intents);
}

}  // namespace irsim
