// When sensors measure, and when their data arrive: a sensor may measure in some steps only, and its data may be late.
//
// Both follow from the number of the step alone: measurement k is due at k / rate, and is taken in the first step that
// ends then or later. Between measurements a sensor shows its last data.
#pragma once

#include <cmath>
#include <cstdint>

#include "fields.hpp"
#include "world/array.hpp"

namespace irsim {

/// The times of a sensor as Python gives them.
struct SensorTiming {
  double rate;     // measurements per second [Hz]; 0: one in each step
  double latency;  // from a measurement to the time at which its data arrive [s]
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using T = SensorTiming;
    return visit(field("rate", &T::rate), field("latency", &T::latency));
  }
};

/// The times of a sensor as numbers of steps, and its place in `Pending`.
struct Timetable {
  double rate = 0.0, latency = 0.0;  // measurements in a step, 0 without a rate, and steps until data arrive, as given
  bool varies = false;               // whether these are drawn for each scene
  double per_step = 1.0;             // measurements in a step, at most 1
  std::int64_t delay = 0;            // steps until data arrive
  std::int64_t slots = 0;            // measurements that may be on their way; 0 without a delay
  std::size_t first_time = 0, first_beam = 0, first_velocity = 0, first_reading = 0;

  /// Whether it always measures in each step, and its data arrive at once.
  bool each_step() const { return per_step >= 1.0 && delay == 0 && !varies; }
  bool operator==(const Timetable& o) const { return per_step == o.per_step && delay == o.delay; }
  /// Number of the last measurement until the end of a step.
  std::int64_t last(std::int64_t step) const {
    constexpr double kShare = 1e-12, kRounding = 1e-9;  // by which a due time may be too late because it is rounded
    if (per_step >= 1.0) return step;
    return static_cast<std::int64_t>(std::floor(static_cast<double>(step) * per_step * (1.0 + kShare) + kRounding));
  }
  /// Whether the sensor measures in a step.
  bool due(std::int64_t step) const { return step == 0 || last(step) > last(step - 1); }
  /// Number of steps since the measurement before the one in this step; 1 if there was none.
  std::int64_t steps_since(std::int64_t step) const {
    std::int64_t steps = 1;
    while (steps < step && !due(step - steps)) ++steps;
    return steps;
  }
  /// The step in which the data were measured that a sensor shows after a step; -1 before the first.
  std::int64_t shown(std::int64_t step) const {
    std::int64_t measured = step - delay;
    while (measured >= 0 && !due(measured)) --measured;
    return measured;
  }
  /// Whether data arrive in a step.
  bool arrives(std::int64_t step) const { return step >= delay && due(step - delay); }
  /// The slot of the last measurement until the end of a step.
  std::size_t slot(std::int64_t step) const { return static_cast<std::size_t>(last(step) % slots); }
};

/// The same times at factors on the rate and on the latency; the place in `Pending` stays.
inline Timetable scaled(Timetable times, double on_rate, double on_latency) {
  constexpr double kRounding = 1e-9;  // share of a step
  times.per_step = times.rate > 0.0 ? std::fmin(1.0, times.rate * on_rate) : 1.0;
  times.delay = static_cast<std::int64_t>(std::ceil(times.latency * on_latency - kRounding));
  return times;
}

/// Number of measurements that may be on their way; 0 without a delay.
inline std::int64_t slots_of(const Timetable& times) {
  return times.delay > 0 ? 2 + static_cast<std::int64_t>(std::ceil(static_cast<double>(times.delay) * times.per_step))
                         : 0;
}

/// The times of a sensor in a world with this step time [s].
inline Timetable timetable_of(const SensorTiming& timing, double step_time) {
  Timetable out;
  out.rate = timing.rate * step_time, out.latency = timing.latency / step_time;
  out = scaled(out, 1.0, 1.0);
  out.slots = slots_of(out);
  return out;
}

/// Measurements of all worlds whose data have not arrived yet, each sensor's in its slots.
struct Pending {
  Array<double> time, ranges, velocities, readings;
  Array<std::int32_t> hits;
  Array<std::uint8_t> valid;
};

}  // namespace irsim
