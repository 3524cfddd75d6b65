// Facts about a drive that behaviors use, whatever its name.
#pragma once

#include <optional>

#include "fields.hpp"
#include "kinematics.gen.hpp"

namespace irsim {

/// How a drive steers; empty unless it steers wheels.
inline std::optional<Car> car_of(const Drive& drive) {
  std::optional<Car> found;
  with(drive, [&](const auto& options) { found = steering(options); });
  return found;
}

/// Whether a drive steers wheels, so that it turns while it rolls.
inline bool steers(const Drive& drive) { return car_of(drive).has_value(); }

/// Whether the controls are forward speed and yaw rate, so that the drive turns on the spot.
template <class Options>
bool is_diff(const Options& drive) {
  const Rows meaning = rows(drive);
  return meaning.travel == 1 && meaning.yaw == 1;
}

inline bool turns_in_place(const Drive& drive) {
  bool found = false;
  with(drive, [&](const auto& options) { found = is_diff(options); });
  return found;
}

/// Whether the speeds of a drive are states of its own, which approach wanted ones without ever being equal to them.
inline bool coasts(const Drive& drive) {
  bool found = false;
  with(drive, [&](const auto& options) { found = rows(options).coasts; });
  return found;
}

}  // namespace irsim
