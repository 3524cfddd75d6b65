// The input and output of sensors. Each header in sensors/ defines for one options struct:
//
//   void                 NAME(options, sensing)  one scan into sensing.ranges, hits, valid (and velocities)
//   std::vector<double>  beams(options)          nominal beam angles, sensor frame
//   int                  velocity_rows(options)  numbers per beam in sensing.velocities; optional, 0 by default
//   int                  readings(options)       numbers in sensing.readings, of sensors that report them instead of
//                                                beams; optional, 0
//   int                  memory(options)         numbers in sensing.memory, which last from step to step; optional, 0
#pragma once

#include <type_traits>

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
  double* readings;               // (mount.readings,)
  double* memory;                 // (mount.memory,)
  const Vec2* object_velocities;  // (N,) world frame [m/s]; null when no sensor of the world measures velocities
  BeamBuffers &buffers, &spare;
  const std::vector<Mount>& parts;    // beams that are cast one part after the other; empty: all at once
  Outlines& ghosts;                   // scratch: the moving objects at another time
  int first_beam = 0, all_beams = 0;  // of the part: its first beam, and the number of beams of the whole scan
  double spin = 0.0;                  // turn of the sensor from beam to beam within the part [rad]
  Vec2 drift;                         // displacement of the sensor from beam to beam within the part [m]
  double beam_time = 0.0;             // time from beam to beam within the part [s]
  bool earlier = false;               // whether the moving objects are where `ghosts` has them
  std::int64_t steps = 1;             // since its last measurement; 0: it only keeps its memory up to date

  /// The draws of the sensor: lane 0 is the noise of ranges, directions and velocities; lanes 1 to 3 are for
  /// lidars with errors: what becomes of a beam, how, and what holds for an episode. Multiples of 2^32 added to lane 0
  /// serve the few of their normal draws that need more than a word.
  Draws draws(std::uint64_t lane = 0) const {
    return Draws(state.key(w), sensor_stream(mount.index), world.number[mount.object], lane);
  }
  /// Whether its numbers are read.
  bool measures() const { return steps > 0; }
  /// Factor on the standard deviations of the sensors of the carrier.
  double noise() const { return state.noise_scale[w * world.objects + mount.object]; }
  Footprint footprint(int object) const {
    const bool ghost = earlier && !world.is_static[object];
    return ghost ? ghosts.footprint(*state.scenes[w].shapes, object) : state.footprint(world, w, object);
  }
  /// Centre and radius of the bounding circle of an object, world frame.
  std::pair<Vec2, double> bounds(int object) const {
    if (!earlier || world.is_static[object]) return state.bounds(world, w, object);
    const Shapes& shapes = *state.scenes[w].shapes;
    return {ghosts.centres[shapes.placed[object].object], shapes.radius[object]};
  }
  std::uint64_t scan_number() const { return static_cast<std::uint64_t>(state.count[w]); }
};

/// The multiple of a step that is nearest to a measured value; the value itself without a step.
inline double nearest_multiple(double value, double step) {
  return step > 0.0 ? step * std::floor(value / step + 0.5) : value;
}

template <class Options>
int velocity_rows(const Options&) {
  return 0;
}

template <class Options>
int readings(const Options&) {
  return 0;
}

template <class Options>
int memory(const Options&) {
  return 0;
}

template <class Options, class = void>
struct HasReach : std::false_type {};
template <class Options>
struct HasReach<Options, std::void_t<decltype(Options::range_max)>> : std::true_type {};

/// The range of a beam that hits nothing [m].
template <class Options>
double farthest(const Options& options) {
  if constexpr (HasReach<Options>::value) {
    return options.range_max;
  } else {
    return kInfinity;
  }
}

template <class Options, class = void>
struct HasOffset : std::false_type {};
template <class Options>
struct HasOffset<Options, std::void_t<decltype(Options::offset)>> : std::true_type {};

/// Pose of a sensor in the body frame [m, m, rad].
template <class Options>
std::array<double, 3> mounted_at(const Options& options) {
  if constexpr (HasOffset<Options>::value) {
    return options.offset;
  } else {
    return {};
  }
}

/// Number of parts of a scan that are cast one after the other while the sensor moves; 1: all beams at once.
template <class Options>
int sweep_parts(const Options&) {
  return 1;
}

/// Take one scan with a sensor of world w, given by its number among those with beams, from a carrier at `pose`, and
/// show it at once.
void scan(const World& world, State& state, int w, int number, const Pose& pose, Vec2 direction, Workspace& work);
/// The ranges that a sensor with beams has measured in this step of world w, though they may not have arrived yet; null
/// if it did not measure.
const double* just_measured(const World& world, const State& state, int w, const Scan& sensor);
/// Let the sensors of an object of a single world show, and have on their way, what the same sensors of an object did
/// in another one at the same step.
void go_on_showing(const World& world, State& state, int object, const World& world_before, const State& before,
                   int object_before);
/// Write the world-frame velocities of all objects of world w to `work.velocities` if a sensor of the world needs them.
void update_object_velocities(const World& world, const State& state, int w, Workspace& work);

}  // namespace irsim
