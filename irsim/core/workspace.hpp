// Scratch memory of one thread, so that a step allocates nothing.
#pragma once

#include <cstdint>
#include <vector>

#include "collision/grid.hpp"

namespace irsim {

struct Intent;

struct BeamBuffers {
  std::vector<double> dx, dy, range, offset, bearing;
  std::vector<std::int32_t> hit;
};

struct Workspace {
  Workspace();
  ~Workspace();
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;

  Grid grid;
  std::vector<int> objects;
  std::vector<Intent> intents;
  BeamBuffers beams;
};

}  // namespace irsim
