// Routes: an object plans a path around static objects, and its behavior drives along it.
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
  double replan;     // time after which a new plan is made [s]; 0: only for a new goal, or when the path is lost
  double lookahead;  // distance along the path of the point to head for [m]; 0: the next corner in sight
  std::vector<std::vector<double>> within;  // corners x, y of the area that the path must not leave [m]; empty: none
  std::vector<int> avoid;                   // zones of the world that are solid for this object
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    return visit(field("planner", &RouteOptions::planner), field("replan", &RouteOptions::replan),
                 field("lookahead", &RouteOptions::lookahead), field("within", &RouteOptions::within),
                 field("avoid", &RouteOptions::avoid));
  }
};

/// The facts that others go by when they meet an object on a route: its state after all routes of a step have been
/// followed, and before one of them reacts to another. So it does not matter which object is declared first.
struct RightOfWay {
  double way = 0.0;       // length of the rest of the path [m]; infinite at the goal and without a path
  int yielded = 0;        // an object that retreats claims the way of the one it lets pass: how many such steps away
  bool held_up = false;   // whether it has made no progress for some time
  std::int64_t held = 0;  // number of steps without progress
};

/// An object's memory of its route from step to step.
struct Route {
  Vec2 goal{kNone, kNone};         // goal of the path
  std::vector<Vec2> path;          // corners from the place of planning to the goal; empty if no path was found
  std::size_t next = 0;            // corner of the path that the object heads for
  std::int64_t planned_at = 0;     // step of the last plan
  std::uint64_t plans = 0;         // number of plans in this episode, so that each has draws of its own
  std::vector<Leg> legs;           // poses through a narrow place; empty where corners are enough
  std::size_t leg = 0;             // leg that the object follows
  int blocked_steps = 0;           // consecutive steps in which something blocked the leg
  bool keeps_heading = false;      // the path is free of collisions only at the present heading
  std::int64_t parking_at = -1;    // step of the last plan to the heading of the goal; -1: none yet
  int backing_steps = 0;           // remaining steps of backing up
  double wall_radius = 0.0;        // radius of the disc about the origin that behaviors keep off walls [m]
  double wall_margin = 0.0;        // gap between the body and walls below which no command is allowed to lead [m]
  double way_ahead = 0.0;          // length of the rest of the path [m]
  double shortest_way = 0.0;       // shortest that it was at the last progress [m]
  std::int64_t progress_at = 0;    // step of that progress
  bool held_up = false;            // whether the object has made no progress for some time
  std::vector<Leg> track;          // last poses of a drive that cannot move sideways, and how each was reached
  bool retreats = false;           // whether the legs lead back along the track; the object then waits there ...
  std::int64_t wait_until = 0;     // ... until this step
  int lets_pass = -1;              // the object that it retreats for
  std::int64_t insists_until = 0;  // an object that could not retreat goes before all others until this step
  RightOfWay right_of_way;
  std::size_t retraced = 0;  // number of legs of that retreat
  bool reported = false;     // whether the missing path to this goal was logged
  // The path is free for a smaller body only, because poses for the whole body were not found from `failed_pose`.
  bool uncertain = false;
  Pose failed_pose{};
  std::vector<int> parked;                     // objects that stand for good, round which the path leads
  std::vector<int> parked_seen;                // those for which a way round was sought last
  bool parked_reported = false;                // whether it was logged that there is no way round them to this goal
  Vec2 resting_at{kNone, kNone};               // the object has been near this point ...
  std::int64_t resting_since = 0;              // ... since this step
  std::shared_ptr<const Fixed> planned_among;  // static objects of the last plan
  std::vector<Body> bodies;                    // 0: for which the path is free of collisions, 1: for lines of sight
};

/// Make the plans that are due and set `State::target` of the objects with a route to the point they head for.
/// `only`: for this object alone.
void find_routes(const World& world, State& state, int w, Workspace& work, int only = -1);
/// Change the commands of objects with a route so that they stay on it and hit no static object.
void keep_routes(const World& world, State& state, int w, Workspace& work, int only = -1);

}  // namespace irsim
