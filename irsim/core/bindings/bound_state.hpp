// The state as Python holds it: the C++ state, its world and the NumPy arrays that view it.
#pragma once

#include <atomic>

#include "bindings/helpers.hpp"
#include "world/state.hpp"

namespace irsim {

using Seeds = nb::ndarray<const std::uint64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Mask = nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

struct BoundState {
  BoundState(World& world, const Seeds& seeds, bool history);
  /// Continue from `before`, with each object as it was in the state and row given for it.
  BoundState(World& world, const BoundState& before, const std::vector<std::pair<BoundState*, int>>& origins);

  World* world;
  State state;
  std::atomic<bool> busy{false};  // whether a thread works on the state without the GIL
  nb::object pose, extra, control, twist, command, commanded, drive, actuated, contact_time, air_time, touching, given,
      arrived, believes_arrived, collided, stopped, radius, vel_min, vel_max, acce, takes_part, size_scale, speed_scale,
      acceleration_scale, noise_scale, delay_scale, lag_scale, sensor_rate_scale, sensor_latency_scale, slip_scale,
      grip_scale, latency, level, variant, pace, start_step, appeared, infeasible, between_steps, goal, ranges, hits,
      valid, beam_angles, velocities, readings, stamp, explored, count, scene, noise, seed, failed_placement;

  /// The C++ state, after a check that it belongs to this world.
  State& of(const World& named);
  void check_row(int row) const;
  void check_world(int w) const;
  void check_mask(const Mask& mask) const;
  void check_idle() const;

 private:
  void expose();
};

/// Marks the state as busy during a call that releases the GIL, so that a second thread gets an error.
class Claim {
 public:
  explicit Claim(BoundState& state) : state_(state) {
    state_.check_idle();
    state_.busy = true;
  }
  ~Claim() { state_.busy = false; }
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;

 private:
  BoundState& state_;
};

/// Add the methods that read shapes of single rows.
void bind_row_geometry(nb::class_<BoundState>& state);

}  // namespace irsim
