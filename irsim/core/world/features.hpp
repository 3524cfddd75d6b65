// All behaviors and sensors, and the lists of who uses them.
#pragma once

#include <vector>

#include "behaviors.gen.hpp"
#include "sensors.gen.hpp"

namespace irsim {

/// Objects of the template with equal behavior, options and group. Of a group behavior, `members` are all objects of
/// the group, those that cannot move too; else they are `objects`.
struct BehaviorGroup {
  Behavior behavior;
  int group;
  bool grouped;
  std::vector<int> objects, members;
};

/// One sensor of the template.
struct Scan {
  Sensor sensor;
  Mount mount;
};

}  // namespace irsim
