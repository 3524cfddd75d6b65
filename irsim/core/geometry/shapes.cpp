#include "geometry/shapes.hpp"

#include <algorithm>

#include "geometry/enclosing_circle.hpp"

namespace irsim {

double twice_area(const std::vector<Vec2>& ring) {
  double sum = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) sum += cross(ring[i], ring[(i + 1) % ring.size()]);
  return sum;
}

namespace {

/// The centroid of a single polygon; `otherwise` for compounds, lines and shapes without area.
Vec2 centroid_of(const std::vector<Outline>& outlines, Vec2 otherwise) {
  if (outlines.size() != 1 || outlines[0].kind != Kind::polygon) return otherwise;
  const std::vector<Vec2>& ring = outlines[0].vertices;
  double area = 0.0;
  Vec2 sum;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    const Vec2 b = ring[i] - ring[0], c = ring[i + 1] - ring[0];
    area += cross(b, c);
    sum = sum + (b + c) * cross(b, c);
  }
  return area != 0.0 ? ring[0] + sum * (1.0 / (3.0 * area)) : otherwise;
}

/// Add the corners of the outermost cells of each row.
void add_extremes(const OccupancyGrid& grid, std::vector<PlainDisc>& discs) {
  for (int j = 0; j < grid.rows(); ++j) {
    int first = grid.next_occupied(j, 0, grid.columns() - 1), last = first;
    if (first < 0) continue;
    for (last = grid.columns() - 1; !grid.occupied(last, j);) --last;
    for (const int side : {0, 1}) {
      discs.push_back({grid.corner(first, j + side)});
      discs.push_back({grid.corner(last + 1, j + side)});
    }
  }
}

}  // namespace

void Shapes::add(const std::vector<Outline>& outlines, bool fixed) {
  std::vector<PlainDisc> discs;
  const int base = static_cast<int>(vertices.size());
  for (const Outline& outline : outlines) {
    Part part{outline.kind, static_cast<int>(vertices.size()) - base, 0, outline.radius, 0.0, outline.cells.get()};
    vertices.insert(vertices.end(), outline.vertices.begin(), outline.vertices.end());
    if (outline.kind == Kind::polygon) {
      const double area = twice_area(outline.vertices);
      part.turn = area > 0.0 ? 1.0 : area < 0.0 ? -1.0 : 0.0;
    }
    if (is_closed(outline.kind) || (outline.kind == Kind::linestring && outline.vertices.size() == 1)) {
      vertices.push_back(outline.vertices.front());
    }
    part.last = static_cast<int>(vertices.size()) - base - 1;
    parts.push_back(part);
    if (outline.cells) {
      grids.push_back(outline.cells);
      add_extremes(*outline.cells, discs);
      continue;
    }
    for (const Vec2& v : outline.vertices) discs.push_back({v, outline.radius});
  }
  if (!scale.empty()) scale.push_back(1.0);
  const PlainDisc around = enclosing_circle(discs);
  centre.push_back(around.centre);
  centroid.push_back(centroid_of(outlines, around.centre));
  radius.push_back(around.radius);
  close(body.back(), fixed);
}

void Shapes::copy(const Shapes& other, int object, bool fixed) {
  const Slot &from = other.body[object], &to = other.body[object + 1];
  for (int p = from.part; p < to.part; ++p) {
    for (const auto& grid : other.grids) {
      if (grid.get() == other.parts[p].cells) grids.push_back(grid);
    }
  }
  parts.insert(parts.end(), other.parts.begin() + from.part, other.parts.begin() + to.part);
  vertices.insert(vertices.end(), other.vertices.begin() + from.vertex, other.vertices.begin() + to.vertex);
  centre.push_back(other.centre[object]);
  centroid.push_back(other.centroid[object]);
  radius.push_back(other.radius[object]);
  if (!scale.empty() || other.scale_of(object) != 1.0) {
    scale.resize(objects() - 1, 1.0);
    scale.push_back(other.scale_of(object));
  }
  close(body.back(), fixed);
}

std::shared_ptr<const Shapes> Shapes::scaled(const double* factors) const {
  auto out = std::make_shared<Shapes>(*this);
  out->scale.resize(objects());
  for (int i = 0; i < objects(); ++i) {
    const double factor = is_map(i) ? 1.0 : factors[i];
    out->scale[i] = scale_of(i) * factor;
    for (int p = body[i].part; p < body[i + 1].part; ++p) out->parts[p].radius *= factor;
    for (int v = body[i].vertex; v < body[i + 1].vertex; ++v) out->vertices[v] = vertices[v] * factor;
    out->centre[i] = centre[i] * factor;
    out->centroid[i] = centroid[i] * factor;
    out->radius[i] *= factor;
    out->arm[i] = out->arm_of(i);
  }
  return out;
}

std::shared_ptr<const Shapes> Shapes::closed() const {
  const auto has_unknown = [&](int i) { return is_map(i) && parts[body[i].part].cells->closed() != nullptr; };
  int first = 0;
  while (first < objects() && !has_unknown(first)) ++first;
  if (first == objects()) return nullptr;
  auto out = std::make_shared<Shapes>(*this);
  for (int i = first; i < objects(); ++i) {
    if (!has_unknown(i)) continue;
    Shapes one;
    one.add({cells_outline(parts[body[i].part].cells->closed())}, true);
    out->parts[body[i].part] = one.parts[0];
    std::copy(one.vertices.begin(), one.vertices.end(), out->vertices.begin() + body[i].vertex);
    out->centre[i] = one.centre[0], out->centroid[i] = one.centroid[0];
    out->radius[i] = one.radius[0], out->arm[i] = one.arm[0];
    out->grids.push_back(one.grids[0]);
  }
  return out;
}

/// Give the last object, which begins at `first`, its slot among the moving or the static objects.
void Shapes::close(const Slot& first, bool fixed) {
  const Slot end{objects(), static_cast<int>(parts.size()), static_cast<int>(vertices.size())};
  Slot& used = size[fixed ? 1 : 0];
  placed.push_back(used);
  used.object += 1;
  used.part += end.part - first.part;
  used.vertex += end.vertex - first.vertex;
  body.push_back(end);
  arm.push_back(arm_of(objects() - 1));
}

double Shapes::arm_of(int object) const {
  const Vec2 middle = centre[object];
  const bool turns_unseen =
      part_count(object) == 1 && parts[body[object].part].kind == Kind::circle && middle.x == 0.0 && middle.y == 0.0;
  return turns_unseen ? 0.0 : std::fabs(middle.x) + std::fabs(middle.y) + radius[object];
}

void Outlines::resize(const Slot& size) {
  vertices.resize(size.vertex);
  part_boxes.resize(size.part);
  boxes.resize(size.object);
  centres.resize(size.object);
}

void Outlines::place(const Shapes& shapes, int object, const Pose& pose, Vec2 direction) {
  const Slot from = shapes.body[object], to = shapes.placed[object];
  const Part* parts = shapes.parts.data() + from.part;
  const bool moves = parts->kind != Kind::cells;
  const Vec2 origin = moves ? pose.position() : Vec2{};
  if (!moves) direction = {1.0, 0.0};
  centres[to.object] = origin + rotate(shapes.centre[object], direction);
  const Vec2* own = shapes.vertices.data() + from.vertex;
  Vec2* placed = vertices.data() + to.vertex;
  Box* own_boxes = part_boxes.data() + to.part;
  const int count = shapes.part_count(object);
  Box all;
  for (int p = 0; p < count; ++p) {
    const Part& part = parts[p];
    Box box;
    if (part.kind == Kind::circle) {
      const Vec2 middle = origin + rotate(own[part.first], direction);
      placed[part.first] = middle;
      box = box_around(middle, part.radius);
    } else {
      for (int v = part.first; v <= part.last; ++v) {
        const Vec2 vertex = origin + rotate(own[v], direction);
        placed[v] = vertex;
        box.include(vertex);
      }
    }
    own_boxes[p] = box;
    all.include(box);
  }
  boxes[to.object] = all;
}

}  // namespace irsim
