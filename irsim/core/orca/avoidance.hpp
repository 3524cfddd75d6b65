// How objects avoid others with the half-planes of ORCA, whatever share of the avoidance they leave to others.
#pragma once

#include <optional>

#include "decision.hpp"
#include "orca/constraints.hpp"

namespace irsim {

/// Options of all behaviors that are built on ORCA.
struct OrcaSettings {
  double neighborDist;                  // objects farther away are ignored [m]
  int maxNeighbors;                     // largest number of other objects considered, nearest first
  double timeHorizon;                   // time horizon for moving objects [s]
  double timeHorizonObst;               // time horizon for walls and static circles [s]
  std::optional<double> maxSpeed;       // [m/s]; none: the limit of the object
  std::optional<double> approach_time;  // time constant of slowing down at the goal [s]; none: full speed
  double sidestep;  // angle to the right of the wanted velocity while something moving is ahead [degrees]
  // share of a change of velocity, without a `Reciprocity`; none: half for objects that give way, else all
  std::optional<double> responsibility = std::nullopt;
};

/// The settings among the options of a behavior.
template <class Options>
OrcaSettings settings_of(const Options& o) {
  return {o.neighborDist, o.maxNeighbors, o.timeHorizon, o.timeHorizonObst, o.maxSpeed, o.approach_time, o.sidestep};
}

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
};

/// Write, for each object of the decision, the velocity nearest to the wanted one that avoids everything.
///
/// Args:
///   reciprocity: Shares of the avoidance of moving objects; null: those of the settings.
void avoid(const OrcaSettings& options, const Decision& decision, Reciprocity* reciprocity, Intent* intents);

}  // namespace irsim
