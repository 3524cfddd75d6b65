// Beliefs of a robot that does not know the truth: the pose that it believes to have, and the tracks that its
// detector reports instead of other objects.
//
// A robot that goes by an estimate places itself on its map by it: goals, routes, zones and whatever stands are where
// the scenario has them, and what moves is where the robot sees it from there. So the same behaviors and policies
// decide from the estimate; only poses and velocities differ.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

struct ObjectSpec;
struct World;
struct State;
struct Workspace;

/// Where a robot finds its beliefs among the readings of its world; -1: it knows the truth.
struct Perception {
  int pose = -1;    // x, y, heading
  int tracks = -1;  // `slots` times `kTrack` numbers
  int slots = 0;

  bool any() const { return pose >= 0 || tracks >= 0; }
};

/// The numbers of a track: its id; position [m] and velocity [m/s] in the frame of the robot; radius [m]; the index of
/// the object that it follows, or -1. NaN where there is no track.
enum Track { kTrackId, kTrackX, kTrackY, kTrackSpeedX, kTrackSpeedY, kTrackRadius, kTrackSource, kTrack };

/// The perception of an object whose sensors have been added to the world.
///
/// Raises: std::invalid_argument if it has no sensor for that.
Perception perception_of(const World& world, int object, const ObjectSpec& spec);

/// Whether an object decides from something else than the truth.
bool believes(const World& world, int object);
/// Whether it decides from an estimated pose.
bool estimates(const World& world, int object);
/// The pose that the object of a row believes to have: the true one, unless it goes by an estimate and has one.
Pose believed_pose(const World& world, const State& state, int row);

/// Another object that moves, as a robot sees it, world frame of its belief.
struct Sighting {
  bool present;
  Pose pose;
  Vec2 velocity;  // [m/s]
};

/// The belief of one robot: scratch memory.
struct Beliefs {
  std::vector<Vec2> velocities;             // (movers,) true ones, which the caller fills in [m/s]
  Pose pose;                                // of the robot itself
  Vec2 turn;                                // from the true world frame to the believed one, cosine and sine
  std::vector<Sighting> movers;             // (movers,) by index in World::moving; the robot itself among them
  std::vector<const double*> false_tracks;  // nearest first
};

/// Fill in what the object of a row believes. Tracks that follow nothing, nearest first, take the places
/// of objects that are not seen, as long as there are any.
void believe(const World& world, const State& state, int row, Beliefs& out);

/// The true data that a belief has replaced, and the belief: scratch memory.
struct Replaced {
  Beliefs beliefs;
  std::vector<Pose> pose;
  std::vector<Vec3> twist;
  std::vector<std::int64_t> appeared;
  std::uint8_t arrived = 0;  // of the object itself
};

/// Puts what one object believes in place of the true state of its world, as long as it lives; without beliefs it does
/// nothing. Static objects stay as they are.
class Belief {
 public:
  Belief(const World& world, State& state, int w, int object, Workspace& work, Replaced& replaced);
  ~Belief();
  Belief(const Belief&) = delete;
  Belief& operator=(const Belief&) = delete;

 private:
  const World& world_;
  State& state_;
  int row_;
  Workspace& work_;
  Replaced& replaced_;
  bool active_;
};

}  // namespace irsim
