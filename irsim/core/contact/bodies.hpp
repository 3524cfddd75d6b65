// Shapes as rigid bodies: convex pieces, centre of mass, mass and inertia.
#pragma once

#include <memory>
#include <vector>

#include "geometry/shapes.hpp"

namespace irsim {

struct World;

/// Part of a body: a disc (one vertex, a radius), a segment (two vertices) or a convex counter-clockwise polygon.
struct Convex {
  int first, count;  // among the vertices of all bodies
  double radius;
};

/// The objects of one scene as contacts see them, body frame.
struct Bodies {
  std::vector<int> begin = {0};             // (N + 1,) first piece of each object
  std::vector<Convex> pieces;               // cover the footprint exactly
  std::vector<Vec2> vertices, normals;      // normals[k]: outward, of the edge from vertex k to the next of its piece
  std::vector<const OccupancyGrid*> cells;  // (N,) of maps, which have no pieces
  std::vector<Vec2> centroid;               // (N,) what a body turns about
  std::vector<double> inverse_mass;         // (N,) [1/kg], 0 for what cannot be pushed
  std::vector<double> gyration2;            // (N,) inertia by shape per mass [m^2]
  std::vector<double> inverse_inertia;      // (N,) [1/(kg m^2)]
};

std::shared_ptr<const Bodies> make_bodies(const World& world, const Shapes& shapes);

/// Convex pieces of a simple polygon, counter-clockwise: itself when convex, else the triangles of its constrained
/// Delaunay triangulation.
std::vector<std::vector<Vec2>> convex_pieces(std::vector<Vec2> ring);

}  // namespace irsim
