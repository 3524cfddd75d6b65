// Forces of many discs on one object, computed column by column: a processor works on several of them at once.
#pragma once

#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

struct SfmOptions;

/// The discs whose forces are wanted, and these forces. All columns have an entry for each disc.
class SocialForces {
 public:
  /// Remove all discs. `most`: how many may be added.
  void clear(std::size_t most);
  /// Add a disc. `way`: from the object to its centre [m]; `faster`: velocity of the object minus its own [m/s].
  void add(Vec2 way, Vec2 faster) {
    way_x_[count_] = way.x, way_y_[count_] = way.y;
    faster_x_[count_] = faster.x, faster_y_[count_] = faster.y;
    ++count_;
  }
  /// Compute the forces: a braking part against the interaction vector and a sideways part. `velocity`: of the object
  /// [m/s].
  void compute(const SfmOptions& options, Vec2 velocity);

  std::size_t count() const { return count_; }
  Vec2 force(std::size_t k) const { return {force_x_[k], force_y_[k]}; }
  /// Whether the opposite of a force is, to the last bit, what the object exerts on the disc. Seen from there, all
  /// vectors have the opposite signs and all numbers are the same. At an angle of 0 or half a turn, the sign of a zero
  /// would count.
  bool mutual(std::size_t k) const { return sine_[k] > 0.0 || sine_[k] < 0.0; }

 private:
  /// Whether the object and a disc straight ahead of its interaction vector come nearer to each other along one line.
  bool meets(std::size_t k, Vec2 velocity) const;

  std::size_t count_ = 0;
  std::vector<double> way_x_, way_y_, faster_x_, faster_y_;
  std::vector<double> distance_, length_;  // of `way`; of the interaction vector
  std::vector<double> along_x_, along_y_;  // direction of the interaction vector
  std::vector<double> sine_, cosine_;      // of the angle from there to `way`, times a positive number
  std::vector<double> reach_, decay_, angle_;
  std::vector<double> force_x_, force_y_;
};

}  // namespace irsim
