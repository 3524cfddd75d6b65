// A fan of beams from one point against footprints.
#pragma once

#include "geometry/shapes.hpp"
#include "world/workspace.hpp"
#include "world/world.hpp"

namespace irsim {

/// Casts all beams of one scan. An edge is tested only against the beams between the bearings of its ends, bodies that
/// are hidden behind what was hit already are skipped, and nearer bodies go first. Results are those of testing every
/// beam against every edge: the nearest hit wins, of equal ones the one of the lowest object.
class Fan {
 public:
  /// `heading`: cosine and sine of the sensor heading, world frame; `reach` [m].
  Fan(BeamBuffers& buffers, Vec2 origin, Vec2 heading, const Mount& mount, double reach);

  /// World-frame unit direction of beam i; `widen` tells how far beams may stray from their nominal angle.
  void aim(int i, Vec2 direction) { buffers_.dx[i] = direction.x, buffers_.dy[i] = direction.y; }
  void widen(double error);

  /// Note a body, by its bounding circle, if it is in reach and in view.
  void consider(int object, Vec2 centre, double radius);
  /// Cast at all bodies noted; `footprint(object)` shows one.
  template <class Footprints>
  void cast(Footprints&& footprint) {
    sort_by_distance();
    for (const BeamBuffers::Body& body : buffers_.bodies) {
      if (!hidden(body)) cast_body(footprint(body.object), body.object);
    }
  }

  int hit(int i) const { return buffers_.hit[i]; }
  double range(int i) const { return buffers_.range[i]; }
  /// World-frame unit direction of beam i.
  Vec2 beam(int i) const { return {buffers_.dx[i], buffers_.dy[i]}; }

 private:
  struct Edge;
  double beam_of(Vec2 from_origin) const;  // nominal beam, fractional, that looks at a point
  template <class Test>
  void between(double low, double high, Test&& test) const;  // the beams from low to high, and those too close to tell
  void sort_by_distance();
  bool hidden(const BeamBuffers::Body& body) const;
  void cast_body(const Footprint& body, int object);
  void cast_circle(const Footprint& body, int part, int object);
  void cast_cells(const OccupancyGrid& grid, int object);
  void cast_edges(const Footprint& body, int part, int object);
  void test(int i, const Edge& edge);
  bool nearer(int i, double range, int object) const;
  bool on_union(int i, double range, const Footprint& body, int part, Vec2 outward) const;

  BeamBuffers& buffers_;
  Vec2 origin_, heading_;
  int count_;
  double reach_, first_, per_radian_, turn_;  // angle of beam 0 [rad]; beams per radian and per turn
  double blur_ = 0.0;                         // how wrong `beam_of` may be [beams]
  bool ordered_;                              // beams are spaced by angle
};

}  // namespace irsim
