// The common part of sensors that report numbers instead of ranges: the motion since the last step, errors that last,
// and zones.
#pragma once

#include <algorithm>
#include <array>
#include <initializer_list>

#include "integration.hpp"
#include "sensing.hpp"

namespace irsim {

/// The first numbers that such a sensor remembers: the step of its last reading, and the pose of the carrier then.
constexpr int kGaugeMemory = 4;

/// Whether a point is in one of some zones.
inline bool in_zones(const World& world, const std::vector<int>& zones, Vec2 at) {
  return std::any_of(zones.begin(), zones.end(), [&](int zone) { return world.zones.covers(zone, at); });
}

/// A block of normal draws; zeros if all their standard deviations are zero, so that nothing is drawn in vain.
inline std::array<double, 4> normals_of(const Draws& draws, std::uint64_t block, std::initializer_list<double> stds) {
  const bool wanted = std::any_of(stds.begin(), stds.end(), [](double std) { return std != 0.0; });
  return wanted ? draws.normals(block) : std::array<double, 4>{};
}

/// The motion of a body since the last step, in its own frame: an arc of constant speed and yaw rate.
struct Travel {
  double ahead, aside, turn;  // [m], [m], [rad]
};

/// Whether a reading is due: not a second time in the same step. The first one of an episode only starts the memory.
enum class Due { no, start, step };

/// Look whether a reading is due, and take note of the step and of the pose of the carrier.
inline Due take_note(const Sensing& s, Travel& travel) {
  const auto count = static_cast<double>(s.state.count[s.w]);
  double* const memory = s.memory;
  const bool starts = s.state.count[s.w] == 0 || !std::isfinite(memory[1]);
  if (!starts && memory[0] == count) return Due::no;
  travel = {};
  if (!starts) {
    travel.turn = wrap(s.pose.theta - memory[3]);
    const Vec2 way = s.pose.position() - Vec2{memory[1], memory[2]};
    const Vec2 chord = unrotate(way, unit(memory[3] + 0.5 * travel.turn));
    const double arc = 1.0 / sinc(0.5 * travel.turn);
    travel.ahead = chord.x * arc, travel.aside = chord.y * arc;
  }
  memory[0] = count, memory[1] = s.pose.x, memory[2] = s.pose.y, memory[3] = s.pose.theta;
  return starts ? Due::start : Due::step;
}

/// Move a pose along the arc of a travel.
inline void travel_on(double* pose, const Travel& travel) {
  const Vec2 way =
      rotate(Vec2{travel.ahead, travel.aside} * sinc(0.5 * travel.turn), unit(pose[2] + 0.5 * travel.turn));
  pose[0] += way.x, pose[1] += way.y;
  pose[2] = wrap(pose[2] + travel.turn);
}

/// Sums of three values over the steps since the last reading, and the number of steps: in the memory of a sensor.
struct SinceReading {
  double* sums;
  static constexpr int kNumbers = 4;

  void start() const { std::fill_n(sums, kNumbers, 0.0); }
  /// Add the values of a step. If it measures, they become the means since the last reading, whose number of steps is
  /// returned, and the sums start anew; else 0 is returned.
  double add(double (&values)[3], bool measures) const {
    if (sums[3] == 0.0 && measures) return 1.0;
    sums[3] += 1.0;
    for (int k = 0; k < 3; ++k) sums[k] += values[k];
    if (!measures) return 0.0;
    const double steps = sums[3];
    for (int k = 0; k < 3; ++k) values[k] = sums[k] / steps;
    start();
    return steps;
  }
};

/// An error that comes and goes: a Gauss-Markov process of the first order, exact for any step.
struct Wandering {
  double std;   // in the long run
  double time;  // in which it falls to 1 / e [s]; 0: it does not change

  double first(double draw) const { return std * draw; }
  double next(double error, double dt, double draw) const {
    if (!(time > 0.0)) return error;
    const double kept = std::exp(-dt / time);
    return kept * error + std * std::sqrt(1.0 - kept * kept) * draw;
  }
};

/// Errors of a motion that add up: variances grow with the way and with the turn, whatever the step.
struct Drift {
  double distance, heading, turning;  // [m per sqrt(m)], [rad per sqrt(m)], [rad per sqrt(rad)]

  Travel add(Travel travel, double draw_ahead, double draw_turn) const {
    const double way = std::hypot(travel.ahead, travel.aside), turn = std::fabs(travel.turn);
    travel.ahead += distance * std::sqrt(way) * draw_ahead;
    travel.turn += std::sqrt(heading * heading * way + turning * turning * turn) * draw_turn;
    return travel;
  }
};

}  // namespace irsim
