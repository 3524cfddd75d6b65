// How drives respond to commands, and how bodies without a drive slide, before contacts are resolved.
#pragma once

#include "drive.hpp"
#include "world/state.hpp"
#include "world/world.hpp"

namespace irsim {

/// Whether a drive is native. Drives in Python and bodies without a drive have no options.
inline bool is_native(const Drive& drive) { return !std::holds_alternative<std::monostate>(drive); }

/// The executed control of a driven row: the command after the lag of its drive and within the grip of its wheels.
/// Drives in Python handle both themselves.
Vec3 respond(const World& world, State& state, int row, Vec3 command);
/// The control of a row without a command. A body without a drive slides until friction stops it. A drive stops, with
/// `collision_mode: contact` within its lag and grip, otherwise at once.
Vec3 without_command(const World& world, State& state, int row);
/// Move a row without a drive for one period. Its control is a world-frame velocity and a yaw rate.
void coast(const World& world, State& state, int row);

/// Largest speed that the limits of the controls allow [m/s].
template <class Options>
double travel_speed(const Options& drive, Vec3 limit) {
  return rows(drive).travel > 1 ? norm({limit[0], limit[1]}) : limit[0];
}

}  // namespace irsim
