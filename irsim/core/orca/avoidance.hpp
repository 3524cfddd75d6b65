// How objects avoid one another with the half-planes of ORCA, whatever share of the avoidance each takes.
#pragma once

#include "decision.hpp"
#include "orca/constraints.hpp"
#include "orca/settings.hpp"

namespace irsim {

/// How objects share the avoidance with others, where the share differs from pair to pair.
class Reciprocity {
 public:
  virtual ~Reciprocity() = default;
  /// Called before the shares of object k of the decision, which is mover `self`.
  virtual void begin(int k, int self) = 0;
  /// Share of the change of velocity that the object makes to avoid mover m; with 0 it does not avoid it at all.
  ///
  /// Args:
  ///   other: Mover m; what the object takes it for may be changed.
  virtual double share(int m, OrcaAgent& other) = 0;
  /// Called if the object and another one are mirror images of each other.
  virtual void tied() {}
};

/// Write, for each object of the decision, the velocity nearest to the wanted one that avoids everything.
///
/// Args:
///   reciprocity: Shares of the avoidance of moving objects; null: from the settings.
void avoid(const OrcaSettings& options, const Decision& decision, Reciprocity* reciprocity, Intent* intents);

}  // namespace irsim
