// How drives answer commands, and bodies without a drive slide, before contacts are resolved.
#pragma once

#include "drive.hpp"
#include "world/state.hpp"
#include "world/world.hpp"

namespace irsim {

/// Whether a drive is one of the core's: others, and bodies without a drive, have no options.
inline bool is_native(const Drive& drive) { return !std::holds_alternative<std::monostate>(drive); }

/// The executed control of a driven row: the lag of its drive, then the grip of its wheels. Drives written in Python
/// answer for themselves.
Vec3 respond(const World& world, State& state, int row, Vec3 command);
/// The control of a row that nobody commands: what has no drive slides until friction stops it, drives stop (at once,
/// unless `collision_mode: contact` knows better).
Vec3 without_command(const World& world, State& state, int row);
/// One period of motion of a row without a drive; its control is a world-frame velocity.
void coast(const World& world, State& state, int row);

/// Largest speed that limits allow [m/s].
template <class Options>
double travel_speed(const Options& drive, Vec3 limit) {
  return rows(drive).travel > 1 ? norm({limit[0], limit[1]}) : limit[0];
}

}  // namespace irsim
