#include "planning/body.hpp"

namespace irsim {

Body Body::disc(double radius) {
  Body body;
  body.add_circle({}, radius);
  body.finish();
  return body;
}

Body Body::box(double half_x, double half_y) {
  Body body;
  body.add_outline(Kind::polygon, {{-half_x, -half_y}, {half_x, -half_y}, {half_x, half_y}, {-half_x, half_y}}, 1.0);
  body.finish();
  return body;
}

Body Body::of(const Shapes& shapes, int object, double heading, double margin) {
  Body body;
  const Slot& slot = shapes.body[object];
  const Vec2 direction = unit(heading);
  for (int p = 0; p < shapes.part_count(object); ++p) {
    const Part& part = shapes.parts[slot.part + p];
    std::vector<Vec2> corners;
    for (int v = part.first; v <= part.last; ++v)
      corners.push_back(rotate(shapes.vertices[slot.vertex + v], direction));
    if (part.kind == Kind::circle) {
      body.add_circle(corners[0], part.radius + margin);
      continue;
    }
    if (margin > 0.0) {  // the exact union of the outline, a disc at every corner and a strip along every edge
      for (int k = 0; k < part.last - part.first; ++k) {
        const Vec2 along = corners[k + 1] - corners[k];
        body.add_circle(corners[k], margin);
        const double length = norm(along);
        if (!(length > 0.0)) continue;
        const Vec2 side = Vec2{-along.y, along.x} * (margin / length);
        body.add_outline(Kind::polygon,
                         {corners[k] - side, corners[k + 1] - side, corners[k + 1] + side, corners[k] + side}, 1.0);
      }
      if (part.kind == Kind::linestring) body.add_circle(corners.back(), margin);
    }
    if (part.kind == Kind::polygon) corners.pop_back();
    body.add_outline(part.kind, std::move(corners), part.turn);
  }
  body.finish();
  return body;
}

void Body::add_circle(Vec2 centre, double radius) {
  const int first = static_cast<int>(vertices_.size());
  parts_.push_back({Kind::circle, first, first, radius, 0.0});
  vertices_.push_back(centre);
}

void Body::add_outline(Kind kind, std::vector<Vec2> vertices, double turn) {
  const int first = static_cast<int>(vertices_.size());
  if (kind == Kind::polygon) vertices.push_back(vertices.front());
  vertices_.insert(vertices_.end(), vertices.begin(), vertices.end());
  parts_.push_back({kind, first, static_cast<int>(vertices_.size()) - 1, 0.0, turn});
}

void Body::finish() {
  for (const Part& part : parts_) {
    Box box;
    for (int v = part.first; v <= part.last; ++v) {
      const Vec2 vertex = vertices_[v];
      box.include(vertex);
      reach_ = std::max(reach_, norm(vertex) + part.radius);
    }
    if (part.kind == Kind::circle) box = box_around(vertices_[part.first], part.radius);
    part_boxes_.push_back(box);
    box_.include(box);
  }
  there_.parts = parts_;
  there_.vertices = vertices_;
  there_.boxes = part_boxes_;
}

const Footprint& Body::at(Vec2 p) {
  for (std::size_t v = 0; v < vertices_.size(); ++v) there_.vertices[v] = vertices_[v] + p;
  for (std::size_t k = 0; k < part_boxes_.size(); ++k) {
    const Box& box = part_boxes_[k];
    there_.boxes[k] = {box.x0 + p.x, box.y0 + p.y, box.x1 + p.x, box.y1 + p.y};
  }
  return there_.done();
}

const Footprint& Body::swept(Vec2 a, Vec2 b) {
  way_.clear();
  const Vec2 along = b - a;
  const double length = norm(along);
  for (const Part& part : parts_) {
    if (part.kind == Kind::circle) {
      const Vec2 centre = vertices_[part.first];
      way_.add_circle(b + centre, part.radius);
      if (!(length > 0.0)) continue;
      const Vec2 side = Vec2{-along.y, along.x} * (part.radius / length);
      const Vec2 strip[] = {a + centre - side, b + centre - side, b + centre + side, a + centre + side};
      way_.add_ring(strip, 4, Kind::polygon, 1.0);
      continue;
    }
    for (int v = part.first; v < part.last; ++v) {
      // Only edges that face forward sweep an area beyond the ring itself.
      const Vec2 edge = vertices_[v + 1] - vertices_[v];
      if (part.turn * cross(along, edge) < 0.0) continue;
      const Vec2 quad[] = {a + vertices_[v], a + vertices_[v + 1], b + vertices_[v + 1], b + vertices_[v]};
      way_.add_ring(quad, 4, Kind::polygon, 0.0);
    }
  }
  return way_.done();
}

void Body::Placed::clear() {
  parts.clear();
  vertices.clear();
  boxes.clear();
}

void Body::Placed::add_circle(Vec2 centre, double radius) {
  const int first = static_cast<int>(vertices.size());
  parts.push_back({Kind::circle, first, first, radius, 0.0});
  vertices.push_back(centre);
  boxes.push_back(box_around(centre, radius));
}

void Body::Placed::add_ring(const Vec2* corners, int count, Kind kind, double turn) {
  const int first = static_cast<int>(vertices.size());
  Box box;
  for (int k = 0; k < count; ++k) {
    vertices.push_back(corners[k]);
    box.include(corners[k]);
  }
  if (kind == Kind::polygon) vertices.push_back(corners[0]);
  parts.push_back({kind, first, static_cast<int>(vertices.size()) - 1, 0.0, turn});
  boxes.push_back(box);
}

const Footprint& Body::Placed::done() {
  Box all;
  for (const Box& box : boxes) all.include(box);
  const Vec2 centre{0.5 * (all.x0 + all.x1), 0.5 * (all.y0 + all.y1)};
  footprint = {parts.data(),
               static_cast<int>(parts.size()),
               vertices.data(),
               boxes.data(),
               all,
               centre,
               0.5 * norm({all.x1 - all.x0, all.y1 - all.y0})};
  return footprint;
}

}  // namespace irsim
