// Scratch memory of one thread, so that steps allocate no memory.
#pragma once

#include <cstdint>
#include <vector>

#include "braking/stops.hpp"
#include "contact/contact.hpp"
#include "orca/crowd.hpp"
#include "orca/opinions.hpp"
#include "planning/problem.hpp"
#include "routes/sides.hpp"
#include "rvo/velocity_obstacles.hpp"
#include "sfm/mutual.hpp"
#include "sfm/social_force.hpp"
#include "surroundings/closing.hpp"
#include "surroundings/neighbors.hpp"
#include "surroundings/perception.hpp"
#include "surroundings/walls.hpp"

namespace irsim {

struct Intent;

struct BeamBuffers {
  struct Body {
    double distance;   // lower bound of the distance to the body [m]
    double low, high;  // first and last beam that may hit it
    int object;
  };
  std::vector<double> dx, dy, range;
  std::vector<std::int32_t> hit;
  std::vector<double> cosine, power;  // of the incidence, and share of its light that returns; for lidars with errors
  std::vector<double> luck;           // uniform draws of a scan, by which beams come back or not
  std::vector<double> cone;           // ranges of the rays of the cones of all beams [m]
  std::vector<Body> bodies, sorted;
};

struct Workspace {
  Workspace();
  ~Workspace();
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;

  std::vector<int> objects;
  std::vector<Intent> intents;
  BeamBuffers beams, blockers;
  std::vector<Vec2> velocities;  // velocities of the objects of a world [m/s]
  std::vector<double> extra;     // copy of a row of State::extra
  std::vector<double> readings;  // of a sensor that does not measure in this step
  Neighbors neighbors;
  MutualForces mutual_forces;
  SocialForces social_forces;
  ContactBuffers contacts;
  FacingWalls walls;  // near an object
  VelocityObstacles velocity_obstacles;
  WallView wall_view;          // walls in the way of an object
  std::vector<Nearby> nearby;  // what an object could reach in one step
  OrcaCrowd orca;
  std::vector<Opinion> opinions;  // from the step before, of the object that decides
  SearchMemory search;            // memory of planners
  Outlines ghost;                 // outline of an object at a pose that is tried
  std::vector<Side> sides;        // lines that an object on a route must not cross
  StopHulls stop_hulls;           // of the objects near one on a route
  Stops stops;
  Replaced replaced;  // by what an object believes

  /// Forget what was computed from the present state, which changes.
  void forget_step() { neighbors.known = orca.known = stops.known = walls.known = false; }
};

}  // namespace irsim
