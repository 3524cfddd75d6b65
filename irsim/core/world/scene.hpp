// Geometry, contacts and events of one world.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "collision/grid.hpp"
#include "collision/points.hpp"
#include "collision/sweep.hpp"
#include "collision/swept.hpp"
#include "contact/contact.hpp"
#include "geometry/shapes.hpp"
#include "orca/obstacles.hpp"
#include "surroundings/walls.hpp"
#include "world/zones.hpp"

namespace irsim {

using Pair = std::pair<int, int>;  // object ids, first < second

/// Pairs of objects of one world that may touch in one step. A crowd has a few for each of its objects; objects in one
/// place have the square of their number, and would fill the memory.
constexpr std::size_t kMostPairs = 1'000'000;

/// The error of a step with more; Python sees a MemoryError.
struct TooManyPairs : std::bad_alloc {
  const char* what() const noexcept override { return "more than 1,000,000 pairs of objects touch in one step"; }
};

/// Add a pair to a list of at most kMostPairs.
template <class List, class Item>
void add_pair(List& list, const Item& item) {
  if (list.size() >= kMostPairs) throw TooManyPairs();
  list.push_back(item);
}

/// The static objects as planners see them, for whom unknown cells of maps are occupied.
struct Closed {
  std::shared_ptr<const Shapes> shapes;
  Outlines outlines;
  Grid grid;
};

/// Outlines of the static objects at their poses, and everything that can be computed from them once. Worlds whose
/// static objects have the same shapes and poses share it.
struct Fixed {
  std::vector<Pose> poses;  // poses of the static objects, in order
  Outlines outlines;
  Grid grid;
  std::vector<Pair> pairs;               // static objects that touch each other
  Walls walls;                           // outlines of static objects other than circles
  std::vector<int> disc_ids;             // ids of the circles
  Points disc_points;                    // centres of these circles
  Obstacles obstacles;                   // all of these in the form that `orca` needs
  std::unique_ptr<const Closed> closed;  // null if all cells of maps are known
};

enum class EventKind {
  arrival,
  waypoint,
  collision,
  no_path,
  overshoot,
  zone_entry,
  zone_exit,
  crossing_to_right,  // of a line, from its left side to its right
  crossing_to_left,
  sight_start,
  sight_end,
  contact_between_steps,  // of two objects that are apart at both ends of the step
  passed_through,         // likewise, and the middle of one went through the other
  believed_arrival        // an object that goes by an estimate rests where it takes its last goal to be
};
constexpr const char* kEventNames[] = {"arrival",          "waypoint",        "collision", "no_path",
                                       "overshoot",        "zone_entry",      "zone_exit", "crossing_to_right",
                                       "crossing_to_left", "sight_start",     "sight_end", "contact_between_steps",
                                       "passed_through",   "believed_arrival"};

struct Event {
  EventKind kind;
  long long step;
  int object;   // World::number; who sees, if it is about a sight
  int partner;  // World::number of the other of a collision, or of whom is seen; index of a zone; otherwise -1
  double x, y;
  double when = 1.0;   // time within the step: 0 its beginning, 1 its end
  double depth = 0.0;  // deepest overlap within the step [m]; 0 unless it is about a contact between steps
};

/// Two objects a < b that touch between two steps and are apart at both.
struct Meeting {
  int a, b;
  double when;  // time of the first contact within the step: 0 its beginning, 1 its end
  Vec2 where;
  double depth;  // deepest overlap [m]
  bool through;  // whether the middle of one went through the other
};

/// Two objects a < b whose motions in a step come near each other.
struct NearPair {
  int a, b;
  double when = kInfinity;  // time of the first contact within the step; infinite without one
  Vec2 where;
  bool judged = false;  // whether it counts as a collision
  bool begins = false;  // whether they are apart when the step begins
};

/// Two objects in contact that stopped where they first touched: they stay in contact while they stay there.
struct HeldPair {
  int a, b;
  Pose pose_a, pose_b;
};

struct Scene {
  std::shared_ptr<const Shapes> shapes;
  std::shared_ptr<const Fixed> fixed;
  Outlines moving;
  Sweep sweep;                              // broad phase of the moving objects
  std::vector<Pair> pairs, previous_pairs;  // colliding objects now and one step before, sorted
  std::vector<Event> events;                // since the last reset
  std::shared_ptr<const Bodies> bodies;     // rigid bodies of `shapes`; null until they are needed
  std::vector<Contact> contacts;            // contacts of the last step, in the order in which they were found
  Watched watched;
  bool in_motion = false;         // whether the objects have moved from `State::before` since the last evaluation
  std::vector<Meeting> meetings;  // of the last step, sorted by objects
  std::vector<NearPair> near;     // of the last step, if contacts within steps are judged
  std::vector<HeldPair> held;
  std::vector<std::uint8_t> bent;  // (N,) whose way contacts have bent in a divided step; empty if it was not divided
  std::vector<Pair> parted;        // objects that pushed each other apart in the last step, sorted
  std::vector<double> until;       // (N,) time within the step at which each object stopped
  std::vector<Box> ways;           // round the motions of the moving objects in the step, by slots in `moving`
  Outlines trial;                  // moving objects at poses within the step
  SweptBuffers swept;
};

}  // namespace irsim
