#include "collision/distance.hpp"

#include "geometry/predicates.hpp"

namespace irsim {
namespace {

/// A part with its world-frame vertices.
struct Piece {
  const Part& part;
  const Vec2* vertices;
  const Box& box;

  const Vec2* begin() const { return vertices + part.first; }
  int edges() const { return part.last - part.first; }
};

double squared_to_edges(const Piece& piece, Vec2 p) {
  double least = kInfinity;
  for (int i = 0; i < piece.edges(); ++i) {
    const Vec2* edge = piece.begin() + i;
    least = std::min(least, squared(nearest_on_segment(edge[0], edge[1], p) - p));
  }
  return least;
}

/// Whether a point lies in the solid side of the outline of a part.
bool in_solid(const Piece& piece, Vec2 p) {
  if (!is_closed(piece.part.kind)) return false;
  return inside_ring(piece.begin(), piece.edges(), p) == (piece.part.kind == Kind::polygon);
}

double depth_in_outline(const Piece& piece, Vec2 p) {
  return in_solid(piece, p) ? std::sqrt(squared_to_edges(piece, p)) : 0.0;
}

double disc_to_outline(const Piece& disc, const Piece& outline) {
  const Vec2 centre = *disc.begin();
  const double away = std::sqrt(squared_to_edges(outline, centre));
  return (in_solid(outline, centre) ? -away : away) - disc.part.radius;
}

/// Squared distance between two segments; 0 if they meet.
double squared_between(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  Vec2 where;
  if (segments_meet(a, b, c, d, where)) return 0.0;
  return std::min(std::min(squared(nearest_on_segment(a, b, c) - c), squared(nearest_on_segment(a, b, d) - d)),
                  std::min(squared(nearest_on_segment(c, d, a) - a), squared(nearest_on_segment(c, d, b) - b)));
}

double outlines_apart(const Piece& a, const Piece& b) {
  double deepest = 0.0;
  bool overlap = false;
  const auto dip = [&](const Piece& of, const Piece& into) {
    for (int i = 0; i <= of.edges(); ++i) {
      const Vec2 p = of.begin()[i];
      if (!in_solid(into, p)) continue;
      overlap = true;
      deepest = std::max(deepest, depth_in_outline(into, p));
    }
  };
  dip(a, b), dip(b, a);
  if (overlap) return -deepest;
  double least = kInfinity;
  for (int i = 0; i < a.edges(); ++i) {
    const Vec2* p = a.begin() + i;
    for (int j = 0; j < b.edges(); ++j) {
      const Vec2* q = b.begin() + j;
      least = std::min(least, squared_between(p[0], p[1], q[0], q[1]));
    }
  }
  return std::sqrt(least);
}

double squared_to_box(const Box& box, Vec2 p) {
  return squared(Vec2{clip(p.x, box.x0, box.x1), clip(p.y, box.y0, box.y1)} - p);
}

double squared_to_box(const Box& box, Vec2 a, Vec2 b) {
  const Vec2 corners[] = {{box.x0, box.y0}, {box.x1, box.y0}, {box.x1, box.y1}, {box.x0, box.y1}};
  double least = std::min(squared_to_box(box, a), squared_to_box(box, b));
  for (int k = 0; k < 4; ++k) least = std::min(least, squared_between(a, b, corners[k], corners[(k + 1) % 4]));
  return least;
}

/// Upper bound of the distance from a point to the nearest occupied cell [m].
double reach_to_cells(const OccupancyGrid& grid, Vec2 p) {
  const Vec2 at{(p.x - grid.origin().x) / grid.cell().x, (p.y - grid.origin().y) / grid.cell().y};
  const int i = static_cast<int>(clip(std::floor(at.x), 0.0, grid.columns() - 1.0));
  const int j = static_cast<int>(clip(std::floor(at.y), 0.0, grid.rows() - 1.0));
  const Box& all = grid.bounds();
  const double farthest = norm({std::max(std::fabs(p.x - all.x0), std::fabs(p.x - all.x1)),
                                std::max(std::fabs(p.y - all.y0), std::fabs(p.y - all.y1))});
  const int cells = grid.clearance(i, j);
  if (cells >= 254) return farthest;  // clearances are counted no farther
  const double to_cell = std::sqrt(squared_to_box(grid.box(i, j), p));
  return std::min(farthest, to_cell + (cells + 1) * norm(grid.cell()));
}

/// Squared distance from a point to the nearest occupied cell.
double squared_to_cells(const OccupancyGrid& grid, Vec2 p) {
  if (grid.count() == 0) return kInfinity;
  double least = kInfinity;
  grid.any_in(grown({p.x, p.y, p.x, p.y}, reach_to_cells(grid, p)), [&](int i, int j) {
    least = std::min(least, squared_to_box(grid.box(i, j), p));
    return false;
  });
  return least;
}

/// Depth of a point in occupied cells: the distance to the nearest free cell; 0 outside.
double depth_in_cells(const OccupancyGrid& grid, Vec2 p) {
  const Vec2 cell = grid.cell();
  const auto column = static_cast<int>(clip(std::floor((p.x - grid.origin().x) / cell.x), -1.0, grid.columns()));
  const auto row = static_cast<int>(clip(std::floor((p.y - grid.origin().y) / cell.y), -1.0, grid.rows()));
  if (!grid.occupied(column, row)) return 0.0;
  const double side = std::min(cell.x, cell.y);
  double least = kInfinity;
  for (int ring = 1; (ring - 1) * side < least; ++ring) {
    for (int j = row - ring; j <= row + ring; ++j) {
      const int step = j == row - ring || j == row + ring ? 1 : 2 * ring;
      for (int i = column - ring; i <= column + ring; i += step) {
        if (!grid.occupied(i, j)) least = std::min(least, std::sqrt(squared_to_box(grid.box(i, j), p)));
      }
    }
  }
  return least;
}

double disc_to_cells(const Piece& disc, const OccupancyGrid& grid) {
  const Vec2 centre = *disc.begin();
  const double inside = depth_in_cells(grid, centre);
  return (inside > 0.0 ? -inside : std::sqrt(squared_to_cells(grid, centre))) - disc.part.radius;
}

double outline_to_cells(const Piece& piece, const OccupancyGrid& grid) {
  Vec2 where;
  if (outline_meets(grid, piece.begin(), piece.edges(), piece.part.kind == Kind::polygon, piece.box, where)) {
    double deepest = 0.0;
    for (int i = 0; i < piece.edges(); ++i) deepest = std::max(deepest, depth_in_cells(grid, piece.begin()[i]));
    grid.any_in(piece.box, [&](int i, int j) {
      for (const int k : {0, 1, 2, 3}) {
        deepest = std::max(deepest, depth_in_outline(piece, grid.corner(i + k % 2, j + k / 2)));
      }
      return false;
    });
    return -deepest;
  }
  double least = kInfinity;
  for (int i = 0; i <= piece.edges(); ++i) least = std::min(least, squared_to_cells(grid, piece.begin()[i]));
  if (!std::isfinite(least)) return least;
  grid.any_in(grown(piece.box, std::sqrt(least)), [&](int i, int j) {
    const Box box = grid.box(i, j);
    for (int k = 0; k < piece.edges(); ++k) {
      least = std::min(least, squared_to_box(box, piece.begin()[k], piece.begin()[k + 1]));
    }
    return false;
  });
  return std::sqrt(least);
}

double pieces_apart(const Piece& a, const Piece& b) {
  if (b.part.cells != nullptr) {
    if (a.part.cells != nullptr) return kInfinity;
    return a.part.kind == Kind::circle ? disc_to_cells(a, *b.part.cells) : outline_to_cells(a, *b.part.cells);
  }
  if (a.part.cells != nullptr) return pieces_apart(b, a);
  if (a.part.kind != Kind::circle) return b.part.kind == Kind::circle ? disc_to_outline(b, a) : outlines_apart(a, b);
  if (b.part.kind != Kind::circle) return disc_to_outline(a, b);
  return norm(*b.begin() - *a.begin()) - a.part.radius - b.part.radius;
}

}  // namespace

double distance(const Footprint& a, const Footprint& b) {
  if (!a.box.finite() || !b.box.finite()) return kNone;
  double least = kInfinity;
  for (int i = 0; i < a.count; ++i) {
    for (int j = 0; j < b.count; ++j) {
      const Piece one{a.parts[i], a.vertices, a.part_boxes[i]}, other{b.parts[j], b.vertices, b.part_boxes[j]};
      least = std::min(least, pieces_apart(one, other));
    }
  }
  return least;
}

}  // namespace irsim
