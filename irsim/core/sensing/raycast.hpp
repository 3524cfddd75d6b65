// Ray casting: a fan of beams from one point against footprints.
#pragma once

#include "geometry/shapes.hpp"
#include "world/workspace.hpp"
#include "world/world.hpp"

namespace irsim {

/// Casts all beams of one scan. An edge is tested only against the beams between the bearings of its ends, nearer
/// bodies are tested first, and bodies hidden behind earlier hits are skipped. The results equal the ones from testing
/// every beam against every edge: the nearest hit counts, among equal ones the lowest object id.
class Fan {
 public:
  /// `heading`: cosine and sine of the sensor heading, world frame; `reach` [m].
  Fan(BeamBuffers& buffers, Vec2 origin, Vec2 heading, const Mount& mount, double reach);

  /// Set the world-frame unit direction of beam i.
  void aim(int i, Vec2 direction) { buffers_.dx[i] = direction.x, buffers_.dy[i] = direction.y; }
  /// Allow for beams that deviate from their nominal angle by `error` [rad].
  void widen(double error);
  /// Allow for the deviations of another fan with the same beams.
  void widen(const Fan& like) { blur_ = like.blur_; }

  /// Remember a body for `cast` if its bounding circle is within reach and in view.
  void consider(int object, Vec2 centre, double radius);
  /// Cast the beams at all bodies remembered; `footprint(object)` returns a body.
  template <class Footprints>
  void cast(Footprints&& footprint) {
    sort_by_distance();
    for (const BeamBuffers::Body& body : buffers_.bodies) {
      if (!hidden(body)) cast_body(footprint(body.object), body.object);
    }
  }

  int hit(int i) const { return buffers_.hit[i]; }
  double range(int i) const { return buffers_.range[i]; }
  const std::int32_t* hits() const { return buffers_.hit.data(); }
  const double* ranges() const { return buffers_.range.data(); }
  int count() const { return count_; }
  Vec2 origin() const { return origin_; }
  Vec2 heading() const { return heading_; }
  double reach() const { return reach_; }
  /// World-frame point in which beam i ends.
  Vec2 end(int i) const { return origin_ + beam(i) * buffers_.range[i]; }
  /// World-frame unit direction of beam i.
  Vec2 beam(int i) const { return {buffers_.dx[i], buffers_.dy[i]}; }

 private:
  struct Edge;
  /// The nominal beam, as a fractional index, that points at a position relative to the origin.
  double beam_of(Vec2 from_origin) const;
  /// Call `test` for the beams from low to high, and for beams that may be among them within the error of `beam_of`.
  template <class Test>
  void between(double low, double high, Test&& test) const;
  bool aside(Vec2 from_origin, double radius) const;
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
  double blur_ = 0.0;                         // largest error of `beam_of` [beams]
  bool ordered_;                              // whether beams are evenly spaced in angle
  bool narrow_;                               // whether they are, and span less than half a turn
  Vec2 before_, after_;                       // then: normals of the first and the last beam, which point away from all
};

}  // namespace irsim
