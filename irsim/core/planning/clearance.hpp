// How much room there is: distances to what stands in the way, on a lattice, and the widest ways between its nodes.
#pragma once

#include <cstdint>
#include <vector>

#include "planning/lattice.hpp"

namespace irsim {

/// Distances from the nodes of a lattice to the nearest obstacle, and a tree of widest ways.
///
/// Each node knows the nearest outline by passing on those of its neighbours (Danielsson: Euclidean distance mapping,
/// 1980); its distance to that outline is exact. A distance is never too short; it is seldom, and then by much less
/// than a cell, too long. What lies outside of the lattice is not seen. Ways go from a node to one of its eight
/// neighbours. A path of a point that keeps a distance d from everything passes cells whose nodes have a distance of at
/// least d minus half the diagonal of a cell.
class Clearance {
 public:
  struct Way {
    double room;  // least distance on the widest way; -infinity if there is none
    int node;     // where it is that
  };

  Clearance(const Blockers& blockers, const Lattice& lattice);

  const Lattice& lattice() const { return lattice_; }
  /// (nodes,) [m]; 0 inside of an obstacle, infinity where there are none.
  const std::vector<float>& distance() const { return distance_; }
  /// The widest way between two nodes.
  Way widest(int a, int b) const;
  /// The same to the best of the nodes within `reach` [m] of a point, from the best within a cell of another.
  Way widest(Vec2 from, Vec2 to, double reach) const;
  /// The roomiest node that can be reached from a point uphill, without going farther than `reach` [m].
  Vec2 climb(Vec2 from, double reach) const;
  /// The shortest way over nodes at least `room` [m] from everything; empty if there is none. Ends count as roomy.
  std::vector<Vec2> way(Vec2 from, Vec2 to, double room) const;

 private:
  struct Feature {
    Vec2 a, b;
    double radius;  // of a circle round a; negative: a segment
  };

  void add(const Part& part, const Vec2* vertices);
  void add_cells(const OccupancyGrid& grid);
  void add_edge(Vec2 a, Vec2 b);
  void add_circle(Vec2 centre, double radius);
  void fill(const Vec2* vertices, int edges, bool outside);
  void offer(int node, int feature);
  /// To the neighbours too: in this cell another outline may be nearer.
  void offer_around(int node, int feature);
  double distance_to(const Feature& feature, Vec2 p) const;
  void spread();
  void join();
  template <class Visit>
  void around(int node, Visit&& visit) const;

  Lattice lattice_;
  Box area_;
  std::vector<Feature> features_;
  std::vector<std::int32_t> nearest_;  // feature of each node, -1 none
  std::vector<std::uint8_t> solid_;    // nodes inside of an obstacle
  std::vector<float> distance_;
  std::vector<std::int32_t> parent_, saddle_;  // the tree: up, and the node over which the two were joined
  std::vector<std::uint32_t> joined_;          // when, counted from 1; 0: a root
};

}  // namespace irsim
