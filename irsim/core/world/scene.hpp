// Geometry, contacts and events of one world.
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
#include "world/zones.hpp"

namespace irsim {

using Pair = std::pair<int, int>;  // object ids, first < second

/// Outlines of the static objects at their poses, and everything that can be computed from them once. Worlds whose
/// static objects have the same shapes and poses share it.
struct Fixed {
  std::vector<Pose> poses;  // poses of the static objects, in order
  Outlines outlines;
  Grid grid;
  std::vector<Pair> pairs;    // static objects that touch each other
  Walls walls, lines;         // outlines of obstacles; segments of linestrings
  std::vector<int> disc_ids;  // ids of the circles
  Points disc_points;         // centres of these circles
  Obstacles obstacles;        // all of these in the form that `orca` needs
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
  sight_end
};
constexpr const char* kEventNames[] = {"arrival",          "waypoint",    "collision", "no_path",
                                       "overshoot",        "zone_entry",  "zone_exit", "crossing_to_right",
                                       "crossing_to_left", "sight_start", "sight_end"};

struct Event {
  EventKind kind;
  long long step;
  int object;   // World::number; who sees, if it is about a sight
  int partner;  // World::number of the other of a collision, or of whom is seen; index of a zone; otherwise -1
  double x, y;
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
};

}  // namespace irsim
