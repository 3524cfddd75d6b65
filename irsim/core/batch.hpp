// Many periods of many worlds, on any number of threads.
#pragma once

#include <functional>

#include "phases.hpp"

namespace irsim {

struct Schedule {
  long long steps;
  int threads;
  bool until_done, external;
};

/// What every step of one world left behind, if recording.
struct Recording {
  std::vector<Pose> pose;                       // (steps, N)
  std::vector<Vec3> control;                    // (steps, N)
  std::vector<std::uint8_t> arrived, collided;  // (steps, N)
  std::vector<double> ranges;                   // (steps, beams)
  long long steps = 0;
};

/// Run all worlds; returns the largest number of steps one of them executed. `recordings`: one per world or null.
long long run_worlds(const World& world, State& state, const Schedule& schedule, std::vector<Recording>* recordings,
                     bool record_ranges);

}  // namespace irsim
