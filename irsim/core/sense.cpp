// Every sensor takes its scan.
#include "features.hpp"
#include "phases.hpp"

namespace irsim {

void sense(const World& world, State& state, int w, Workspace& work) {
  const std::size_t base = static_cast<std::size_t>(w) * world.beams_per_world;
  for (const Scan& scan : world.scans) {
    const std::size_t at = base + scan.mount.first;
    const Sensing sensing{world,
                          state,
                          w,
                          scan.mount,
                          state.ranges.data + at,
                          state.hits.data + at,
                          state.valid.data + at,
                          state.beam_angles.data + at,
                          work.beams};
    with(scan.sensor, [&](const auto& options) { run(options, sensing); });
  }
}

}  // namespace irsim
