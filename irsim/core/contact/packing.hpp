// An order of boxes in which nearby boxes are close to each other.
#pragma once

#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

/// Sort-tile-recursive packing of boxes (Leutenegger, Lopez, Edgington 1997) with ten boxes per node. `rank[i]` is the
/// position of box i in a depth-first walk of the packed tree.
class Packing {
 public:
  void pack(const std::vector<Box>& boxes);
  std::vector<int> rank;

 private:
  struct Node {
    Box box;
    int first, last;  // nodes of the level below; for a leaf both are the index of the box
  };
  void walk(std::size_t level, const Node& node, int& place);

  std::vector<std::vector<Node>> levels_;
};

}  // namespace irsim
