// The input and output of sensors. Each header in sensors/ defines for one options struct:
//
//   void                 NAME(options, sensing)  one scan into sensing.ranges, hits, valid (and velocities)
//   std::vector<double>  beams(options)          nominal beam angles, sensor frame
//   int                  velocity_rows(options)  numbers per beam in sensing.velocities; optional, 0 by default
#pragma once

#include "world/state.hpp"
#include "world/workspace.hpp"
#include "world/world.hpp"

namespace irsim {

struct Sensing {
  const World& world;
  const State& state;
  int w;
  const Mount& mount;
  Pose pose;                      // of the carrier, world frame
  Vec2 direction;                 // cosine and sine of its heading
  double* ranges;                 // (mount.count,) [m]
  std::int32_t* hits;             // (mount.count,) object id or -1
  std::uint8_t* valid;            // (mount.count,) 1: a hit within [range_min, range_max]
  double* velocities;             // (velocity_rows, mount.count) [m/s]
  const Vec2* object_velocities;  // (N,) world frame [m/s]; null when no sensor of the world has velocity rows
  BeamBuffers &buffers, &spare;

  /// The draws of the sensor: lane 0 is the noise of ranges, directions and velocities, lane 1 what realism adds.
  Draws draws(std::uint64_t lane = 0) const {
    return Draws(state.key(w), sensor_stream(mount.index), world.number[mount.object], lane);
  }
  /// Factor on the standard deviations of the sensors of the carrier.
  double noise() const { return state.noise_scale[w * world.objects + mount.object]; }
  std::uint64_t scan_number() const { return static_cast<std::uint64_t>(state.count[w]); }
};

template <class Options>
int velocity_rows(const Options&) {
  return 0;
}

/// Take one scan of a sensor of world w whose carrier is at `pose`.
void scan(const World& world, State& state, int w, const Scan& sensor, const Pose& pose, Vec2 direction,
          Workspace& work);
/// Write the world-frame velocities of all objects of world w to `work.velocities` if a sensor of the world needs them.
void update_object_velocities(const World& world, const State& state, int w, Workspace& work);

}  // namespace irsim
