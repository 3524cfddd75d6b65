// Shapes of one world: parts in the body frame (`Shapes`) and at their poses in the world frame (`Outlines`).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "geometry/vec.hpp"
#include "maps/occupancy.hpp"
#include "random.hpp"

namespace irsim {

/// A room is a closed line that is solid outside. Cells belong to a map; their vertices are two corners of the box
/// around them.
enum class Kind : std::uint8_t { circle, polygon, linestring, room, cells };

/// Whether the last edge of a part leads back to its first vertex.
inline bool is_closed(Kind kind) { return kind == Kind::polygon || kind == Kind::room; }

/// A part as a shape header makes it. A circle has one vertex, its centre, and a radius.
struct Outline {
  Kind kind;
  std::vector<Vec2> vertices;
  double radius = 0.0;
  std::shared_ptr<const OccupancyGrid> cells = nullptr;
};

/// A part made of cells; its vertices are the corners of the box around them.
inline Outline cells_outline(std::shared_ptr<const OccupancyGrid> grid) {
  const Box& box = grid->bounds();
  return {Kind::cells, {{box.x0, box.y0}, {box.x1, box.y1}}, 0.0, std::move(grid)};
}
/// The part as planners see it, for whom unknown cells of a map are occupied.
inline Outline closed_outline(const Outline& part) {
  return part.cells != nullptr && part.cells->closed() != nullptr ? cells_outline(part.cells->closed()) : part;
}

/// Whether a shape is drawn for each scene; random shapes overload this function.
template <class Shape>
constexpr bool is_drawn(const Shape&) {
  return false;
}

/// Twice the area of a ring, positive if counter-clockwise.
double twice_area(const std::vector<Vec2>& ring);

/// One part in `Shapes`. Closed kinds repeat their first vertex at the end, so that edge k goes from vertex k to k + 1.
struct Part {
  Kind kind;
  int first, last;  // first and last vertex of the object; a circle has one vertex, other kinds at least two
  double radius;
  double turn;  // +1 counter-clockwise polygon, -1 clockwise, 0 no interior
  const OccupancyGrid* cells = nullptr;
};

/// Where an object starts in arrays of objects, parts and vertices.
struct Slot {
  int object = 0, part = 0, vertex = 0;
};

/// Body-frame geometry of N objects.
struct Shapes {
  std::vector<Slot> body = {{}};  // (N + 1,) first part and vertex of each object in the arrays below
  std::vector<Part> parts;
  std::vector<Vec2> vertices;
  std::vector<Vec2> centre;    // (N,) centre of the minimum bounding circle
  std::vector<Vec2> centroid;  // (N,) centroid of a circle or polygon; equal to `centre` for other shapes
  std::vector<double> radius;  // (N,)
  std::vector<double> arm;    // (N,) upper bound of what a turn of 1 rad moves a body by; 0 for a disc about its origin
  std::vector<Slot> placed;   // (N,) slots in the `Outlines` of the moving or of the static objects
  Slot size[2];               // sizes of these two
  std::vector<double> scale;  // (N,) factor of each object; empty if all are 1
  std::vector<std::shared_ptr<const OccupancyGrid>> grids;  // keeps the cells of maps alive

  int objects() const { return static_cast<int>(centre.size()); }
  /// Whether an object is a map. The pose of a map does not move its cells.
  bool is_map(int object) const { return parts[body[object].part].kind == Kind::cells; }
  int part_count(int object) const { return body[object + 1].part - body[object].part; }
  void add(const std::vector<Outline>& outlines, bool fixed);
  /// Add a copy of an object of `other`.
  void copy(const Shapes& other, int object, bool fixed);
  /// The same shapes, each scaled about the origin of its body frame by its entry of (N,) factors; maps stay as they
  /// are.
  std::shared_ptr<const Shapes> scaled(const double* factors) const;
  /// The same shapes as planners see them, for whom unknown cells of maps are occupied; null if all cells are known.
  std::shared_ptr<const Shapes> closed() const;
  double scale_of(int object) const { return scale.empty() ? 1.0 : scale[object]; }

 private:
  void close(const Slot& first, bool fixed);
  double arm_of(int object) const;
};

/// World-frame geometry of one object, ready for collision and sensing.
struct Footprint {
  const Part* parts;
  int count;
  const Vec2* vertices;   // world frame, indexed by Part::first..last
  const Box* part_boxes;  // (count,)
  Box box;
  Vec2 centre;
  double radius;
};

/// World-frame geometry of the moving or of the static objects.
struct Outlines {
  std::vector<Vec2> vertices;
  std::vector<Box> part_boxes;
  std::vector<Box> boxes;
  std::vector<Vec2> centres;

  void resize(const Slot& size);
  void place(const Shapes& shapes, int object, const Pose& pose, Vec2 direction);
  Footprint footprint(const Shapes& shapes, int object) const {
    const Slot& slot = shapes.placed[object];
    return {shapes.parts.data() + shapes.body[object].part,
            shapes.part_count(object),
            vertices.data() + slot.vertex,
            part_boxes.data() + slot.part,
            boxes[slot.object],
            centres[slot.object],
            shapes.radius[object]};
  }
};

}  // namespace irsim
