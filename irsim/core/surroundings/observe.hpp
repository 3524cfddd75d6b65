// The knowledge of a simulation's robots about themselves and their surroundings: for observation parts and for
// policies.
#pragma once

#include <cstdint>
#include <vector>

#include "observing.hpp"
#include "surroundings/bounding_circles.hpp"
#include "surroundings/perception.hpp"

namespace irsim {

/// The observed objects besides the robots themselves.
struct Looking {
  int neighbors;                      // number of nearest other objects
  double reach;                       // largest gap between bounding circles [m]
  bool statics;                       // whether static objects count
  bool extents;                       // whether it is measured how far footprints reach toward each other
  std::vector<std::uint8_t> steered;  // (N,) whether the first extra state of an object is a steering angle
  std::vector<int> first_beam;        // (N,) first beam of the lidar of each object among all beams of its world
  int beams;                          // number of beams of a lidar, 0 if it is not observed
  double range_max;                   // [m]
};

/// The neighbors of a row, with the memory for finding them. As long as the state stays as it is, it serves for any
/// row.
struct Near {
  int world = -1;  // whose bounding circles are known
  std::vector<BoundingCircle> circles;
  NearestRows nearest;
  std::vector<Neighbor> neighbors;
  Beliefs beliefs;  // of the row, if it does not know the truth
};

/// Looks at rows of a state, which stays as it is meanwhile.
class Observer {
 public:
  Observer(const World& world, const State& state, const Looking& looking)
      : world_(world), state_(state), looking_(looking) {}

  /// The knowledge of a row; its neighbors are written to `near`, which the result points to.
  Seen see(int row, Near& near) const;

 private:
  /// Find the nearest objects as the object of a row believes them to be.
  void find_believed(int row, Near& near) const;
  Neighbor neighbor(int row, const BoundingCircle& circle) const;
  void measure_extents(int row, int other, Neighbor& neighbor) const;

  const World& world_;
  const State& state_;
  const Looking& looking_;
};

}  // namespace irsim
