// The input and output of behaviors.
#pragma once

#include <vector>

#include "world/state.hpp"
#include "world/world.hpp"

namespace irsim {

/// K objects of one world that share a behavior, its options and their group. All behaviors read the same snapshot.
struct Decision {
  const World& world;
  const State& state;
  int first_row;       // row of object 0 of this world
  const int* objects;  // (K,) ids within the world
  int count;           // K
  const std::vector<int>&
      members;      // ids of all objects of the behavior, or of the group, including objects that do not decide now
  bool grouped;     // from `group_behavior`: members know each other
  Workspace& work;  // scratch memory
  // (R,) memory of `avocado`: of objects that do not decide only ties before this step are read
  Opinions* opinions;
  Detour* detours;     // (R,) memory of `footprint_orca`: only the row of an object that decides is read and written
  std::int64_t* tied;  // (R,) memory of `rvo`, likewise

  int w() const { return first_row / world.objects; }
  int row(int k) const { return first_row + objects[k]; }
};

/// The intent of an object: either a world-frame velocity, which its drive turns into controls, or controls.
struct Intent {
  enum Kind { velocity_world, control_body } kind = velocity_world;
  Vec2 velocity;
  Turning turning;
  Vec3 control;
  bool final = false;       // whether the control already turns the object to the heading of its goal
  bool infeasible = false;  // whether no velocity avoids every collision; the intent is then the least bad one

  static Intent of_velocity(Vec2 v, const Turning& turning = {}) { return {velocity_world, v, turning, {}}; }
  static Intent of_control(Vec3 u) { return {control_body, {}, {}, u}; }
};

}  // namespace irsim
