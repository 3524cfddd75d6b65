#include "pictures/trails.hpp"

#include <algorithm>
#include <cmath>

namespace irsim {

void add_trail(const RecordedWay& way, const TrailCut& cut, std::vector<Vec2>& points,
               std::vector<std::int64_t>& ranges) {
  const std::int64_t recorded = static_cast<std::int64_t>(way.count);
  const std::int64_t first = cut.longest < 0 ? 0 : std::max<std::int64_t>(0, recorded - 1 - cut.longest);
  const bool whole = first == 0;  // then the line begins at the start
  const std::int64_t count = recorded == 0 ? 0 : recorded - first + whole, last = count - 1;
  const std::size_t pieces = cut.ages.size() - 1, begin = ranges.size();
  const auto index = [&](std::int64_t age) { return age < 0 ? 0 : std::max<std::int64_t>(0, last - age); };
  for (std::size_t k = 0; k < pieces; ++k) {
    const std::int64_t from = index(cut.ages[k]);
    ranges.push_back(from);
    ranges.push_back(std::max(from, index(cut.ages[k + 1])));
  }
  if (count < 2) {
    std::fill(ranges.begin() + static_cast<std::ptrdiff_t>(begin), ranges.end(), points.size());
    return;
  }
  const auto place = [&](std::int64_t i) {
    const double* state = way.states + static_cast<std::size_t>(first + i - whole) * way.columns;
    const bool start = whole && i == 0;
    const Vec2 at = start ? way.start : Vec2{state[0], state[1]};
    if (way.offset == 0.0) return at;
    const double heading = start ? way.start_heading : state[2];
    return at + Vec2{-std::sin(heading), std::cos(heading)} * way.offset;
  };
  // Pieces follow one another, so their borders are met in turn.
  std::size_t border = begin;
  double along = 0.0, bin = 0.0;
  Vec2 before = place(0);
  for (std::int64_t i = 0; i < count; ++i) {
    const Vec2 at = place(i);
    bool kept = cut.least <= 0.0;
    if (i > 0 && !kept) {
      along += norm(at - before);
      const double now = std::floor(along / cut.least);
      kept = now != bin;
      bin = now;
    }
    before = at;
    const std::int64_t number = static_cast<std::int64_t>(points.size());
    for (; border < ranges.size() && ranges[border] == i; ++border, kept = true) ranges[border] = number;
    if (kept) points.push_back(at);
  }
  for (std::size_t k = begin + 1; k < ranges.size(); k += 2) {
    if (ranges[k] > ranges[k - 1]) ++ranges[k];  // the end of a range is behind its last point
  }
}

}  // namespace irsim
