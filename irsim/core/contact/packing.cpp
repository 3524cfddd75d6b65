#include "contact/packing.hpp"

#include <algorithm>
#include <cmath>

namespace irsim {
namespace {

constexpr int kCapacity = 10;  // children of a node

int ceiling(int a, int b) { return (a + b - 1) / b; }

}  // namespace

void Packing::pack(const std::vector<Box>& boxes) {
  const int n = static_cast<int>(boxes.size());
  rank.assign(boxes.size(), 0);
  if (levels_.empty()) levels_.emplace_back();
  levels_[0].clear();
  for (int i = 0; i < n; ++i) levels_[0].push_back({boxes[i], i, i});
  std::size_t top = 0;
  for (bool first = true; first || levels_[top].size() > 1; first = false, ++top) {
    if (levels_.size() == top + 1) levels_.emplace_back();
    std::vector<Node>& below = levels_[top];
    std::vector<Node>& above = levels_[top + 1];
    above.clear();
    const int count = static_cast<int>(below.size());
    if (count == 0) return;
    const int slices = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(ceiling(count, kCapacity)))));
    const int per_slice = ceiling(count, slices);
    const auto by_x = [](const Node& a, const Node& b) {
      const double p = a.box.x0 + a.box.x1, q = b.box.x0 + b.box.x1;
      return p != q ? p < q : a.first < b.first;
    };
    const auto by_y = [](const Node& a, const Node& b) {
      const double p = a.box.y0 + a.box.y1, q = b.box.y0 + b.box.y1;
      return p != q ? p < q : a.first < b.first;
    };
    std::sort(below.begin(), below.end(), by_x);
    for (int start = 0; start < count; start += per_slice) {
      const int end = std::min(count, start + per_slice);
      std::sort(below.begin() + start, below.begin() + end, by_y);
      for (int k = start; k < end; k += kCapacity) {
        Node node{{}, k, std::min(end, k + kCapacity)};
        for (int c = node.first; c < node.last; ++c) node.box.include(below[c].box);
        above.push_back(node);
      }
    }
  }
  int place = 0;
  walk(top, levels_[top].front(), place);
}

void Packing::walk(std::size_t level, const Node& node, int& place) {
  if (level == 0) {
    rank[node.first] = place++;
    return;
  }
  for (int c = node.first; c < node.last; ++c) walk(level - 1, levels_[level - 1][c], place);
}

}  // namespace irsim
