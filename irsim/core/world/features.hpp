// All behaviors and sensors, and which objects use them.
#pragma once

#include <vector>

#include "behaviors.gen.hpp"
#include "sensing/timetable.hpp"
#include "sensors.gen.hpp"

namespace irsim {

/// Objects of the template with equal behavior, options and group. For a group behavior `members` are all objects of
/// the group, including static ones; otherwise `members` equals `objects`.
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
  std::vector<Mount> parts;  // of the beams, which are cast one after the other; empty: all at once
  Timetable times;
  double farthest;  // the range of a beam that hits nothing [m]
};

}  // namespace irsim
