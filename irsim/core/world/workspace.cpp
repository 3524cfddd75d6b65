// Members of structs that hold lists of features.
#include "world/features.hpp"

#include "decision.hpp"
#include "world/workspace.hpp"

namespace irsim {

Workspace::Workspace() = default;
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

}  // namespace irsim
