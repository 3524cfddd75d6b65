// One step of learners: their commands, what it has led to, and what they are rewarded for.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/vec.hpp"
#include "rewards.gen.hpp"
#include "world/array.hpp"
#include "world/world.hpp"

namespace irsim {

struct State;

/// When a world starts its next episode: when all learners are done, when any is, or already when one collides.
enum class WorldEnds { all, any, collision };

/// A reward term and its weight; one without options is computed elsewhere and is 0 here.
using WeightedTerm = std::pair<RewardTerm, double>;

/// The ends of episodes.
struct Ends {
  bool arrival, collision;  // of a learner
  WorldEnds world;
};

/// The learners of W worlds, A in each. Slot w * A + a is learner a of world w.
struct Learners {
  Learners(const State& state, std::vector<int> indices, std::vector<ObjectKind> kinds, std::vector<WeightedTerm> terms,
           Ends ends);

  std::size_t each() const { return indices.size(); }

  std::vector<int> indices;       // (A,) indices of the learners in a world
  std::vector<ObjectKind> kinds;  // (N,) what each object is to them
  std::vector<WeightedTerm> terms;
  Ends ends;
  // present episodes
  Array<std::uint8_t> taking_part, ended, arrived, collided;  // (W * A,)
  Array<std::uint8_t> over;                                   // (W,)
  Array<std::int64_t> horizon;                                // (W,) steps after which an episode is cut off
  // at the start of the step, (W * A,)
  std::vector<Pose> pose_before, goal_before;
  std::vector<Vec3> control_before;
};

/// The commands of learners: (W * A, width) controls, or velocities in the world frame (width 2) [m/s].
struct Commands {
  const double* numbers;
  std::size_t width;
  bool velocities;
};

/// The outcome of a step, see `irsim.learning.step.Result`. Terms come first: (T, W * A).
struct Outcome {
  double *terms, *reward;
  std::uint8_t *terminated, *truncated, *active, *arrived, *collided;  // (W * A,)
  std::uint8_t* over;                                                  // (W,)
};

/// Keep what the learners of world w are, and command them. Those whose episode has ended stand still. Without commands
/// they follow their behaviors.
void begin_step(const World& world, State& state, Learners& learners, int w, const Commands* commands);
/// Find out what the step has led to in world w.
void end_step(const World& world, const State& state, Learners& learners, int w, const Outcome& out);

}  // namespace irsim
