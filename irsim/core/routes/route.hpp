// Routes: objects that plan a path on the inflated map and let their behavior drive along it.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "fields.hpp"
#include "geometry/vec.hpp"
#include "planners.gen.hpp"
#include "planning/pose_search.hpp"
#include "planning/problem.hpp"

namespace irsim {

struct Fixed;
struct World;
struct State;
struct Workspace;

struct RouteOptions {
  Planner planner;
  double replan;     // plan anew after this time [s]; 0: only for a new goal, or when the path is lost
  double lookahead;  // head for the point this far along the path [m]; 0: for the next corner in sight
  static constexpr auto fields() {
    return std::make_tuple(field("planner", &RouteOptions::planner), field("replan", &RouteOptions::replan),
                           field("lookahead", &RouteOptions::lookahead));
  }
};

/// What an object remembers of its route.
struct Route {
  Vec2 goal{kNone, kNone};             // that of the path
  std::vector<Vec2> path;              // from where it was planned to the goal; empty: there is none
  std::size_t next = 0;                // of the path: the corner headed for
  std::int64_t planned_at = 0;         // step
  std::uint64_t plans = 0;             // made in this episode
  std::vector<Leg> legs;               // poses of a narrow way; empty: corners are enough
  std::size_t leg = 0;                 // of those: the one headed for
  int waits = 0;                       // steps in a row in which something was in the way of a leg
  bool hold = false;                   // the heading is kept: the path is free for that one
  int backing = 0;                     // steps for which it goes on backing out of a corner
  double room = 0.0;                   // behaviors keep a disc so large about the origin off walls [m]
  bool told = false;                   // that there is no path to this goal
  bool unsure = false;                 // it is free for less than the whole body: poses were looked for in vain
  Pose tried{};                        // where that was
  Vec2 stood{kNone, kNone};            // where the object has been ...
  std::int64_t stood_at = 0;           // ... since this step
  std::shared_ptr<const Fixed> among;  // the static objects it was planned among
  std::vector<Body> bodies;            // for which it is free of collisions, and for which sight is asked for
};

/// Plan where that is due; `State::target` of the objects with a route becomes the point to head for.
/// `only`: for that object alone.
void find_routes(const World& world, State& state, int w, Workspace& work, int only = -1);
/// The commands of objects with a route made such that they stay on it and run into nothing that stands still.
void keep_routes(const World& world, State& state, int w, Workspace& work, int only = -1);

}  // namespace irsim
