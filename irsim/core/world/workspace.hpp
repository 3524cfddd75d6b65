// Scratch memory of one thread, so that a step allocates nothing.
#pragma once

#include <cstdint>
#include <vector>

#include "contact/contact.hpp"
#include "orca/crowd.hpp"
#include "planning/problem.hpp"
#include "rvo/velocity_obstacles.hpp"
#include "surroundings/neighbors.hpp"

namespace irsim {

struct Intent;

struct BeamBuffers {
  struct Body {
    double distance;   // nothing of it is nearer [m]
    double low, high;  // beams that may see it
    int object;
  };
  std::vector<double> dx, dy, range;
  std::vector<std::int32_t> hit;
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
  std::vector<Vec2> velocities;  // of the objects of a world
  std::vector<double> extra;     // a row of State::extra
  Neighbors neighbors;
  ContactBuffers contacts;
  std::vector<int> walls;  // those near
  VelocityObstacles velocity_obstacles;
  OrcaCrowd orca;
  SearchMemory search;  // of planners
  Outlines ghost;       // moving objects where they might be
};

}  // namespace irsim
