// Members of structs that hold lists of features.
#include "features.hpp"

#include "decision.hpp"
#include "workspace.hpp"

namespace irsim {

Workspace::Workspace() = default;
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

}  // namespace irsim
