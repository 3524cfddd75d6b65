// An order in which boxes that are near each other come together.
#pragma once

#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

/// Sort-tile-recursive packing of boxes (Leutenegger, Lopez, Edgington 1997), ten to a node: `rank[i]` is the place of
/// box i when the packed tree is walked.
class Packing {
 public:
  void pack(const std::vector<Box>& boxes);
  std::vector<int> rank;

 private:
  struct Node {
    Box box;
    int first, last;  // in the level below; of a leaf: the box itself
  };
  void walk(std::size_t level, const Node& node, int& place);

  std::vector<std::vector<Node>> levels_;
};

}  // namespace irsim
