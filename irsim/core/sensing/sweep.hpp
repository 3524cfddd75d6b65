// The time that a scan takes: each beam sees the world as it was then, from where the sensor was then.
//
// The scan is cast in parts. Within one the sensor stays where it was in the middle of the part, while its beams point
// where they pointed at their own times: with 8 parts a turn of 0.1 s at 2 m/s and 2 rad/s errs by less than 1 cm.
#pragma once

#include "sensing.hpp"
#include "sensing/lidar_errors.hpp"

namespace irsim {

/// Part `k` of a scan: its beams, the sensor and the moving objects at its time, before the end of the step.
Sensing part_of_sweep(const LidarErrors& errors, const Sensing& sensing, int k);

/// Call `take` for each part of a scan, the last of which ends with the step.
template <class Take>
void sweep(const LidarErrors& errors, const Sensing& sensing, Take&& take) {
  if (sensing.parts.empty()) return take(sensing);
  for (int k = 0; k < static_cast<int>(sensing.parts.size()); ++k) take(part_of_sweep(errors, sensing, k));
}

}  // namespace irsim
