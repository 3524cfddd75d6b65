// The input and output of planners.
#pragma once

#include <cstdint>
#include <vector>

#include "planning/lattice.hpp"
#include "random.hpp"

namespace irsim {

/// Memory that searches reuse.
struct SearchMemory {
  struct Entry {
    double key;
    std::uint32_t order;
    int node;
    bool operator<(const Entry& other) const {  // for heaps with the smallest key on top
      return key > other.key || (key == other.key && order > other.order);
    }
  };
  std::vector<std::uint8_t> open, closed;
  std::vector<double> cost;
  std::vector<int> parent;
  std::vector<Entry> heap;
};

struct Problem {
  const Space& space;
  Vec2 start, goal;
  const Space* tight;  // the space without a margin, in which start and goal are reached. If null, grid planners start
                       // and end in the cells of start and goal instead of at these points.
  const Lattice* own;  // cells of the map, or null
  bool explain;        // whether the nodes examined are returned
  Draws draws;
  std::uint64_t first_draw;  // first block of four draws that may be used
  SearchMemory& memory;
};

/// A path from start to goal; empty without a path.
struct Plan {
  std::vector<Vec2> path;
  double cost = kInfinity;    // length of the path [m]
  std::vector<Vec2> nodes;    // points that were examined
  std::vector<int> parents;   // (nodes,) index of the point from which each was reached, or -1
  std::vector<double> costs;  // (nodes,) length of the path there [m]
};

double path_length(const std::vector<Vec2>& path);
/// Remove the points of a path that the body can leave out.
void shorten(const Space& space, std::vector<Vec2>& path);

}  // namespace irsim
