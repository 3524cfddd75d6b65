// Clearance: distances to the nearest obstacle on a lattice, and the widest paths between its nodes.
#pragma once

#include <cstdint>
#include <vector>

#include "planning/lattice.hpp"

namespace irsim {

/// Distances from the nodes of a lattice to the nearest obstacle, and a tree of widest paths.
///
/// Neighboring nodes pass on their nearest outlines (Danielsson: Euclidean distance mapping, 1980). The distance to the
/// outline found is exact. It is thus never too short; in rare cases it is too long by much less than a cell. Obstacles
/// outside of the lattice are ignored. Paths go from a node to one of its eight neighbors. A point that keeps a
/// distance d from all obstacles passes only cells whose nodes have a distance of at least d minus half the diagonal of
/// a cell.
class Clearance {
 public:
  struct Way {
    double room;  // clearance of the widest path [m]; -infinity without a path
    int node;     // node at which the path has this clearance
  };

  Clearance(const Blockers& blockers, const Lattice& lattice);

  const Lattice& lattice() const { return lattice_; }
  /// (nodes,) [m]; 0 inside of an obstacle, infinity without any obstacle.
  const std::vector<float>& distance() const { return distance_; }
  /// The widest path between two nodes.
  Way widest(int a, int b) const;
  /// The widest path from a node within a cell of `from` to a node within `reach` [m] of `to`.
  Way widest(Vec2 from, Vec2 to, double reach) const;
  /// Go from a point to nodes of ever larger distance, no farther away than `reach` [m], and return the last one.
  Vec2 climb(Vec2 from, double reach) const;
  /// The shortest path over nodes with a distance of at least `room` [m]; empty without a path. The ends need none.
  std::vector<Vec2> way(Vec2 from, Vec2 to, double room) const;

 private:
  struct Feature {
    Vec2 a, b;
    double radius;  // of a circle with the centre `a` [m]; negative for a segment
  };

  void add(const Part& part, const Vec2* vertices);
  void add_cells(const OccupancyGrid& grid);
  void add_edge(Vec2 a, Vec2 b);
  void add_circle(Vec2 centre, double radius);
  void fill(const Vec2* vertices, int edges, bool outside);
  void offer(int node, int feature);
  /// Offer a feature to a node and its neighbors, because another outline may be nearer in this cell.
  void offer_around(int node, int feature);
  double distance_to(const Feature& feature, Vec2 p) const;
  void spread_features();
  void join_nodes();
  template <class Visit>
  void around(int node, Visit&& visit) const;

  Lattice lattice_;
  Box area_;
  std::vector<Feature> features_;
  std::vector<std::int32_t> nearest_;  // nearest feature of each node, -1 without one
  std::vector<std::uint8_t> solid_;    // 1 for nodes inside of an obstacle
  std::vector<float> distance_;
  std::vector<std::int32_t> parent_, saddle_;  // tree: parent of each node, node over which both were joined
  std::vector<std::uint32_t> joined_;          // order of that join, from 1; 0 for a root
};

}  // namespace irsim
