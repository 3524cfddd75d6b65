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
  std::vector<Pose> pose;                                // (steps, N)
  std::vector<Vec3> control;                             // (steps, N)
  std::vector<Goal> goal;                                // (steps, N) heads of the queues
  std::vector<std::uint8_t> arrived, collided, stopped;  // (steps, N)
  std::vector<double> ranges;                            // (steps, beams)
  std::vector<float> returns;                            // (steps, beams) the same, infinite where nothing was hit
  long long steps = 0;
};

/// What of the scans is recorded.
struct Scans {
  bool ranges, returns;
};

/// Run all worlds; returns the largest number of steps one of them executed. `recordings`: one per world or null.
long long run_worlds(const World& world, State& state, const Schedule& schedule, std::vector<Recording>* recordings,
                     Scans scans);

}  // namespace irsim
