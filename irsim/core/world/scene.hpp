// Geometry and records of one world.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "collision/grid.hpp"
#include "collision/points.hpp"
#include "collision/sweep.hpp"
#include "contact/contact.hpp"
#include "geometry/shapes.hpp"
#include "orca/obstacles.hpp"
#include "surroundings/walls.hpp"

namespace irsim {

using Pair = std::pair<int, int>;  // object ids, first < second

/// Outlines of the static objects, where they are, and what never has to be asked again about them. Shared between
/// worlds in which they stand alike.
struct Fixed {
  std::vector<Pose> poses;  // of the static objects, in order
  Outlines outlines;
  Grid grid;
  std::vector<Pair> pairs;    // static objects that meet each other
  Walls walls, lines;         // outlines that are in the way; linestrings
  std::vector<int> disc_ids;  // of the circles
  Points disc_points;         // centres of their bounding circles
  Obstacles obstacles;        // all of these as `orca` sees them
};

enum class EventKind { arrival, waypoint, collision, no_path };
constexpr const char* kEventNames[] = {"arrival", "waypoint", "collision", "no_path"};

struct Event {
  EventKind kind;
  long long step;
  int object, partner;  // their numbers; partner -1 unless a collision
  double x, y;
};

struct Scene {
  std::shared_ptr<const Shapes> shapes;
  std::shared_ptr<const Fixed> fixed;
  Outlines moving;
  Sweep sweep;                              // of the moving objects
  std::vector<Pair> pairs, previous_pairs;  // sorted
  std::vector<Event> events;                // since the last reset
  std::shared_ptr<const Bodies> bodies;     // of `shapes`; null until contacts are looked for
  std::vector<Contact> contacts;            // of the last step, in the order they were found
};

}  // namespace irsim
