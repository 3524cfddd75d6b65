// Two objects on their ways through a step.
#pragma once

#include "collision/swept.hpp"
#include "world/state.hpp"
#include "world/world.hpp"

namespace irsim {

/// The motion of an object in this step, from `State::before` to its present pose.
Stride stride_of(const World& world, const State& state, int w, int object);

/// The boxes that hold the moving objects throughout the step, by their slots in `Scene::moving`, once `place_moving`
/// has put them where the step ends.
void bound_steps(const World& world, State& state, int w, std::vector<Box>& out);

/// Whether two objects are obstacles for each other whose bounding circles come near each other in the step: no other
/// pair touches within it.
bool come_near(const World& world, const State& state, int w, int a, int b);

/// The encounter of two objects a < b that come near each other in a step.
class Passage {
 public:
  Passage(const World& world, State& state, int w, int a, int b);

  /// Let one of them stop at a time and rest until the end of the step.
  void stop(int object, double time);
  /// The first time in [begin, end] at which they touch; infinite if they do not. Objects that are unobstructed touch
  /// nothing, and one that appears in this step was not there before.
  double first_contact(double begin, double end, Vec2& where) const;
  /// Distance at a time within the step [m], negative if they overlap.
  double gap(double time) const;
  /// Whether they touch, or push each other, at a time within the step.
  bool in_contact(double time) const;
  /// Whether two objects that come within a rounding error of each other at a time overlap afterwards.
  bool overlap_after(double when) const;

  int a, b;
  Moving one, other;

 private:
  /// Whether a line certainly separates them throughout the step.
  bool stay_apart() const;
  Footprint footprint(int object, const Moving& body, double time) const;
  bool touch_at(double time) const;

  const World& world_;
  State& state_;
  Scene& scene_;
  int w_;
  bool whole_ = true;  // whether neither stops within the step
};

/// Keep a contact between two steps in `Scene::meetings`.
void keep_meeting(const World& world, State& state, int w, const Passage& passage, double when, Vec2 where);

}  // namespace irsim
