// Special members, for which `Intent` must be complete.
#include "world/workspace.hpp"

#include "decision.hpp"
#include "world/features.hpp"

namespace irsim {

Workspace::Workspace() = default;
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

}  // namespace irsim
