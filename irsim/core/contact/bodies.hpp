// Shapes as rigid bodies: convex pieces, centre of mass, mass and inertia.
#pragma once

#include <memory>
#include <vector>

#include "geometry/shapes.hpp"

namespace irsim {

struct World;

/// A piece of a body: a disc (one vertex and a radius), a segment (two vertices) or a convex counter-clockwise polygon.
struct Convex {
  int first, count;  // range in the vertices of all bodies
  double radius;
};

/// Share of the widths of two bodies. If one moves farther into the other, its way out is on the far side.
constexpr double kFast = 0.5;

/// The objects of one scene as rigid bodies, body frame.
struct Bodies {
  std::vector<int> begin = {0};  // (N + 1,) first piece of each object
  std::vector<Convex> pieces;    // together they cover the footprint exactly
  std::vector<Vec2> vertices,
      normals;  // normals[k]: outward normal of the edge from vertex k to the next one of its piece
  std::vector<const OccupancyGrid*> cells;  // (N,) cells of maps, which have no pieces; else null
  // Each piece without its outermost quarter, as parts in the body frame; empty for objects that cannot be pushed.
  std::vector<int> core_begin = {0};  // (N + 1,) first part of each object
  std::vector<Part> cores;
  std::vector<Vec2> core_vertices;
  std::vector<double> width;  // (N,) least extent of the thinnest piece or cell [m]
  double thinnest = kInfinity,
         lightest = kInfinity;          // least width of obstructing objects, and of those to be pushed [m]
  std::vector<double> inner;            // (N,) radius of a disc round the origin inside a piece, or 0 [m]
  std::vector<Vec2> centroid;           // (N,) centres of mass
  std::vector<double> inverse_mass;     // (N,) [1/kg], 0 for objects that cannot be pushed
  std::vector<double> gyration2;        // (N,) square of the radius of gyration [m^2]
  std::vector<double> inverse_inertia;  // (N,) [1/(kg m^2)]
};

std::shared_ptr<const Bodies> make_bodies(const World& world, const Shapes& shapes);

/// Counter-clockwise convex pieces of a simple polygon: the polygon itself if it is convex, else the triangles of its
/// constrained Delaunay triangulation.
std::vector<std::vector<Vec2>> convex_pieces(std::vector<Vec2> ring);

}  // namespace irsim
