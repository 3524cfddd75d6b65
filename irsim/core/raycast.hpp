// A fan of beams from one point against footprints.
#pragma once

#include "shapes.hpp"
#include "workspace.hpp"
#include "world.hpp"

namespace irsim {

/// Beams are tested only against what lies between the bearings of an edge, so work grows with what is seen, not with
/// beams times edges.
class Fan {
 public:
  /// `heading`: cosine and sine of the sensor heading, world frame; `reach` [m].
  Fan(BeamBuffers& buffers, Vec2 origin, Vec2 heading, const Mount& mount, double reach);

  /// World-frame unit direction of beam i; `widen` tells how far beams may stray from their nominal angle.
  void aim(int i, Vec2 direction) { buffers_.dx[i] = direction.x, buffers_.dy[i] = direction.y; }
  void widen(double error);

  void cast(const Footprint& body, int object);

  int hit(int i) const { return buffers_.hit[i]; }
  double range(int i) const { return buffers_.range[i]; }

 private:
  struct Edge;
  double beam_of(Vec2 from_origin) const;  // nominal beam, fractional, that looks at a point
  template <class Test>
  void between(double low, double high, Test&& test);  // beams from low to high, and a guard on both sides
  void cast_circle(const Footprint& body, int part, int object);
  void cast_edges(const Footprint& body, int part, int object);
  void test(int i, const Edge& edge);
  void record(int i, double range, const Footprint& body, int part, Vec2 outward, int object);

  BeamBuffers& buffers_;
  Vec2 origin_, heading_;
  int count_;
  double reach_, first_, per_radian_, turn_, guard_;  // beams per radian and per turn; guard in beams
  double stray_ = 0.0;                                // [rad]
  bool narrow_;                                       // beams are ordered by angle and spaced
};

}  // namespace irsim
