// What sensors read and write; each header in sensors/ defines, for one options struct,
//
//   void                 NAME(options, sensing)  one scan into sensing.ranges and sensing.hits
//   std::vector<double>  beams(options)          nominal beam angles, sensor frame
#pragma once

#include "state.hpp"
#include "workspace.hpp"
#include "world.hpp"

namespace irsim {

struct Sensing {
  const World& world;
  const State& state;
  int w;
  const Mount& mount;
  double* ranges;       // (mount.count,) [m]
  std::int32_t* hits;   // (mount.count,) object id or -1
  std::uint8_t* valid;  // (mount.count,) 1: a hit within [range_min, range_max]
  double* angles;       // (mount.count,) nominal angle [rad], sensor frame
  BeamBuffers& buffers;

  int row() const { return w * world.objects + mount.object; }
  Draws draws() const { return Draws(state.key(w), sensor_stream(mount.index), world.number[mount.object]); }
};

}  // namespace irsim
