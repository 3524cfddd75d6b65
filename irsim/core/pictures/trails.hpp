// Trails of objects as lines in pieces, of which each has its age.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

/// The way of one object, as its state records it.
struct RecordedWay {
  const double* states = nullptr;  ///< (count, columns) x, y [m], heading [rad], ...
  std::size_t count = 0, columns = 3;
  Vec2 start;                ///< before the first state
  double start_heading = 0;  ///< [rad]
  double offset = 0;         ///< of the line from the position, to the left [m]
};

/// Which parts of ways are drawn.
struct TrailCut {
  std::vector<std::int64_t> ages;  ///< borders of the pieces [steps], the oldest first; -1 is before any other age
  std::int64_t longest = -1;       ///< how far back the line reaches [steps]; -1 to the start
  double least = 0;                ///< least distance along the line from one point to the next [m]
};

/// Append the points of a trail, and the begin and end of each of its pieces among all points; pieces may be empty.
void add_trail(const RecordedWay& way, const TrailCut& cut, std::vector<Vec2>& points,
               std::vector<std::int64_t>& ranges);

}  // namespace irsim
