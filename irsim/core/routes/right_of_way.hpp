// Who goes first where objects on routes meet. As long as they move they share the avoidance. One that gets no nearer
// to its goal is held up; then the one with the longer way ahead gives way alone, so that two at a door do not block
// each other for good. One that retreats for another goes first where the other would, so that those behind it retreat
// as well.
#pragma once

namespace irsim {

struct World;
struct State;

/// Whether an object drives along its route in this step.
bool follows_route(const World& world, const State& state, int w, int object);

/// Set the `RightOfWay` of all objects on routes in world w.
void publish_rights_of_way(const World& world, State& state, int w);

enum class Precedence { shared, first, second };

/// Whether `object` goes before `other`, objects of world w, or shares the avoidance with it. Both orders of the
/// arguments agree.
Precedence precedence(const World& world, const State& state, int w, int object, int other);

}  // namespace irsim
