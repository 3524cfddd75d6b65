// What a planner is asked, and what it answers.
#pragma once

#include <cstdint>
#include <vector>

#include "planning/lattice.hpp"
#include "random.hpp"

namespace irsim {

/// Memory of searches, kept from one to the next.
struct SearchMemory {
  struct Entry {
    double key;
    std::uint32_t order;
    int node;
    bool operator<(const Entry& other) const {  // for heaps with the least on top
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
  const Space* tight;  // the same without a margin: how start and goal are reached. Null: a grid planner starts and
                       // ends in the cells of start and goal, not at these points.
  const Lattice* own;  // cells of the map planned on, or null
  bool explain;        // keep what was looked at
  Draws draws;
  std::uint64_t first_draw;  // blocks of four draws from here on
  SearchMemory& memory;
};

/// A path from start to goal; empty if there is none.
struct Plan {
  std::vector<Vec2> path;
  double cost = kInfinity;    // length of the path [m]
  std::vector<Vec2> nodes;    // points that were looked at
  std::vector<int> parents;   // (nodes,) the point each was reached from; -1: none
  std::vector<double> costs;  // (nodes,) length of the way there [m]
};

double path_length(const std::vector<Vec2>& path);
/// The path without the points that the body can leave out.
void shorten(const Space& space, std::vector<Vec2>& path);

}  // namespace irsim
