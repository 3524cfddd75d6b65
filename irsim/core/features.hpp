// All behaviors and sensors, and the lists of who uses them.
#pragma once

#include <vector>

#include "behaviors.gen.hpp"
#include "sensors.gen.hpp"

namespace irsim {

/// Objects of the template with equal behavior, options and group.
struct BehaviorGroup {
  Behavior behavior;
  int group;
  std::vector<int> objects;
};

/// One sensor of the template.
struct Scan {
  Sensor sensor;
  Mount mount;
};

}  // namespace irsim
