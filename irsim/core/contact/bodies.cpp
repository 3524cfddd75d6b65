#include "contact/bodies.hpp"

#include <array>

#include "contact/triangulate.hpp"
#include "geometry/predicates.hpp"
#include "world/spec.hpp"
#include "world/world.hpp"

namespace irsim {
namespace {

bool is_convex(const std::vector<Vec2>& ring) {
  const std::size_t n = ring.size();
  for (std::size_t k = 0; k < n; ++k) {
    if (turn_of(ring[k], ring[(k + 1) % n], ring[(k + 2) % n]) < 0.0) return false;
  }
  return true;
}

void add_piece(Bodies& bodies, const Vec2* vertices, int count, double radius) {
  bodies.pieces.push_back({static_cast<int>(bodies.vertices.size()), count, radius});
  for (int k = 0; k < count; ++k) {
    const Vec2 along = vertices[(k + 1) % count] - vertices[k];
    const double length = norm(along);
    bodies.vertices.push_back(vertices[k]);
    bodies.normals.push_back(length > 0.0 ? Vec2{along.y, -along.x} * (1.0 / length) : Vec2{});
  }
}

/// Add the solid part behind one side of a convex room. `turn` is positive for a counter-clockwise ring.
void add_wall(Bodies& bodies, Vec2 a, Vec2 b, double turn) {
  constexpr double kThickness = 10.0;  // of the walls of a room [m]
  const Vec2 along = (b - a) * (1.0 / norm(b - a)), out = Vec2{along.y, -along.x} * (turn < 0.0 ? -1.0 : 1.0);
  const Vec2 from = a - along * kThickness, to = b + along * kThickness, away = out * kThickness;
  std::vector<Vec2> wall = {from, from + away, to + away, to};
  if (twice_area(wall) < 0.0) std::reverse(wall.begin(), wall.end());
  add_piece(bodies, wall.data(), 4, 0.0);
}

void add_part(Bodies& bodies, const Part& part, const Vec2* vertices) {
  const Vec2* begin = vertices + part.first;
  if (part.kind == Kind::circle) return add_piece(bodies, begin, 1, part.radius);
  const int edges = part.last - part.first;
  if (part.kind == Kind::cells) return;
  if (part.kind == Kind::room) {
    const double turn = twice_area({begin, begin + edges}) > 0.0 ? 1.0 : -1.0;
    for (int k = 0; k < edges; ++k) add_wall(bodies, begin[k], begin[k + 1], turn);
    return;
  }
  if (part.kind == Kind::linestring) {
    for (int k = 0; k < edges; ++k) add_piece(bodies, begin + k, 2, 0.0);
    return;
  }
  for (const std::vector<Vec2>& piece : convex_pieces({begin, begin + edges})) {
    add_piece(bodies, piece.data(), static_cast<int>(piece.size()), 0.0);
  }
}

struct Measure {
  double size = 0.0;   // area of a polygon or circle, length of lines
  Vec2 moment;         // first moment
  double polar = 0.0;  // second moment of a polygon about the origin
};

Measure measure(const Part& part, const Vec2* vertices) {
  const Vec2* begin = vertices + part.first;
  if (part.kind == Kind::circle) {
    const double area = kPi * part.radius * part.radius;
    return {area, *begin * area, 0.0};
  }
  Measure sum;
  for (int k = 0; k < part.last - part.first; ++k) {
    const Vec2 a = begin[k], b = begin[k + 1];
    if (part.kind == Kind::linestring) {
      const double length = norm(b - a);
      sum.size += length;
      sum.moment = sum.moment + (a + b) * (0.5 * length);
    } else {
      const double c = part.turn * cross(a, b);
      sum.size += c / 2.0;
      sum.moment = sum.moment + (a + b) * (c / 6.0);
      sum.polar += c * (dot(a, a) + dot(a, b) + dot(b, b)) / 12.0;
    }
  }
  return sum;
}

/// The least extent of a piece.
double width_of(const Bodies& bodies, const Convex& piece) {
  if (piece.count == 1) return 2.0 * piece.radius;
  double least = kInfinity;
  for (int k = piece.first; k < piece.first + piece.count; ++k) {
    double most = 0.0;
    for (int v = piece.first; v < piece.first + piece.count; ++v)
      most = std::max(most, dot(bodies.normals[k], bodies.vertices[k] - bodies.vertices[v]));
    least = std::min(least, most);
  }
  return least;
}

/// The least extent of the thinnest piece of an object, or of the cells of a map.
double width_of(const Bodies& bodies, int object) {
  double least = kInfinity;
  if (const OccupancyGrid* cells = bodies.cells[object]) least = std::min(cells->cell().x, cells->cell().y);
  for (int p = bodies.begin[object]; p < bodies.begin[object + 1]; ++p)
    least = std::min(least, width_of(bodies, bodies.pieces[p]));
  return least;
}

constexpr double kShell = 0.25;  // share of the width of a piece that is left away from its core on each side

/// A convex ring without what is less than `by` [m] inside of its edges.
std::vector<Vec2> inset(const Bodies& bodies, const Convex& piece, double by) {
  std::vector<Vec2> ring(&bodies.vertices[piece.first], &bodies.vertices[piece.first] + piece.count), kept;
  for (int k = piece.first; k < piece.first + piece.count; ++k) {
    const auto inside = [&](Vec2 p) { return dot(bodies.normals[k], bodies.vertices[k] - p) - by; };
    kept.clear();
    for (std::size_t v = 0; v < ring.size(); ++v) {
      const Vec2 from = ring[v], to = ring[v + 1 < ring.size() ? v + 1 : 0];
      const double at_from = inside(from), at_to = inside(to);
      if (at_from >= 0.0) kept.push_back(from);
      if ((at_from < 0.0) != (at_to < 0.0)) kept.push_back(from + (to - from) * (at_from / (at_from - at_to)));
    }
    std::swap(ring, kept);
  }
  return ring;
}

void add_core(Bodies& bodies, const Convex& piece) {
  std::vector<Vec2>& vertices = bodies.core_vertices;
  const Vec2* corners = &bodies.vertices[piece.first];
  const int first = static_cast<int>(vertices.size());
  const double by = kShell * width_of(bodies, piece);
  if (piece.count == 1) {
    vertices.push_back(*corners);
    bodies.cores.push_back({Kind::circle, first, first, piece.radius - by, 0.0});
    return;
  }
  const std::vector<Vec2> ring = piece.count > 2 ? inset(bodies, piece, by) : std::vector<Vec2>{};
  const bool thick = ring.size() > 2;
  const Vec2* begin = thick ? ring.data() : corners;
  vertices.insert(vertices.end(), begin, begin + (thick ? ring.size() : piece.count));
  if (piece.count > 2) vertices.push_back(*begin);
  const int last = static_cast<int>(vertices.size()) - 1;
  bodies.cores.push_back({piece.count > 2 ? Kind::polygon : Kind::linestring, first, last, 0.0, 1.0});
}

/// Radius of the largest disc round the origin inside a piece of an object, or 0.
double inner_of(const Bodies& bodies, int object) {
  double most = 0.0;
  for (int p = bodies.begin[object]; p < bodies.begin[object + 1]; ++p) {
    const Convex& piece = bodies.pieces[p];
    double least = piece.count == 1 ? piece.radius - norm(bodies.vertices[piece.first]) : kInfinity;
    for (int k = piece.first; piece.count > 1 && k < piece.first + piece.count; ++k)
      least = std::min(least, dot(bodies.normals[k], bodies.vertices[k]));
    most = std::max(most, least);
  }
  return most;
}

}  // namespace

std::vector<std::vector<Vec2>> convex_pieces(std::vector<Vec2> ring) {
  if (twice_area(ring) < 0.0) std::reverse(ring.begin(), ring.end());
  if (is_convex(ring)) return {ring};
  std::vector<std::vector<Vec2>> pieces;
  for (const Triangle& t : triangulate(ring)) pieces.push_back({ring[t[0]], ring[t[1]], ring[t[2]]});
  return pieces;
}

std::shared_ptr<const Bodies> make_bodies(const World& world, const Shapes& shapes) {
  auto bodies = std::make_shared<Bodies>();
  for (int i = 0; i < world.objects; ++i) {
    const Vec2* vertices = shapes.vertices.data() + shapes.body[i].vertex;
    const int parts = shapes.part_count(i);
    Measure whole;
    for (int p = 0; p < parts; ++p) {
      const Part& part = shapes.parts[shapes.body[i].part + p];
      add_part(*bodies, part, vertices);
      const Measure m = measure(part, vertices);
      whole.size += m.size;
      whole.moment = whole.moment + m.moment;
      whole.polar += m.polar;
    }
    bodies->cells.push_back(shapes.is_map(i) ? shapes.parts[shapes.body[i].part].cells : nullptr);
    bodies->begin.push_back(static_cast<int>(bodies->pieces.size()));
    bodies->width.push_back(width_of(*bodies, i));
    const bool pushable = world.dynamics[i].pushable;
    for (int p = bodies->begin[i]; pushable && p < bodies->begin[i + 1]; ++p) add_core(*bodies, bodies->pieces[p]);
    bodies->core_begin.push_back(static_cast<int>(bodies->cores.size()));
    if (!world.unobstructed[i]) {
      bodies->thinnest = std::min(bodies->thinnest, bodies->width[i]);
      if (pushable) bodies->lightest = std::min(bodies->lightest, bodies->width[i]);
    }
    bodies->inner.push_back(inner_of(*bodies, i));
    Vec2 centre = whole.size > 0.0 ? whole.moment * (1.0 / whole.size) : shapes.centre[i];
    const std::vector<double>& given = world.specs[i].centroid;
    const double scale = shapes.scale_of(i);
    if (given.size() >= 2) centre = Vec2{given[0], given[1]} * scale;
    bodies->centroid.push_back(centre);
    const BodyDynamics& dynamics = world.dynamics[i];
    bodies->inverse_mass.push_back(dynamics.pushable ? 1.0 / dynamics.mass : 0.0);
    double per_mass = 0.5 * shapes.radius[i] * shapes.radius[i];
    const bool polygon = parts == 1 && shapes.parts[shapes.body[i].part].kind == Kind::polygon && whole.size > 0.0;
    if (polygon) per_mass = whole.polar / whole.size - squared(centre);
    if (given.size() == 3) per_mass = given[2] * scale * scale;
    bodies->gyration2.push_back(per_mass);
    const double inertia = std::isnan(dynamics.inertia) ? dynamics.mass * per_mass : dynamics.inertia;
    bodies->inverse_inertia.push_back(dynamics.pushable && inertia > 0.0 ? 1.0 / inertia : 0.0);
  }
  return bodies;
}

}  // namespace irsim
