// Many periods of many worlds on any number of threads.
#pragma once

#include <functional>

#include "phases.hpp"

namespace irsim {

struct Schedule {
  long long steps;
  int threads;
  bool until_done, external;
};

/// The recorded values of every step of one world.
struct Recording {
  std::vector<Pose> pose;                                // (steps, N)
  std::vector<Vec3> control;                             // (steps, N)
  std::vector<Goal> goal;                                // (steps, N) heads of the goal queues
  std::vector<std::uint8_t> arrived, collided, stopped;  // (steps, N)
  std::vector<double> ranges;                            // (steps, beams)
  std::vector<float> returns;                            // (steps, beams) ranges [m], infinite without a valid hit
  long long steps = 0;
};

/// Which values of the scans are recorded.
struct Scans {
  bool ranges, returns;
};

/// Have up to this number of threads for the worlds, with a workspace each, and return their number.
int hire(State& state, int threads);
/// Advance world w by one period; world 0 is recorded if a record is attached.
void step_and_log(const World& world, State& state, int w, Workspace& work, bool external);
/// Run all worlds and return the largest number of steps that one of them executed. `recordings`: one per world, or
/// null.
long long run_worlds(const World& world, State& state, const Schedule& schedule, std::vector<Recording>* recordings,
                     Scans scans);

}  // namespace irsim
