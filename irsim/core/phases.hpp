// The phases of one period of one world; `step` is their sequence.
#pragma once

#include "world/state.hpp"
#include "world/world.hpp"

namespace irsim {

void decide(const World& world, State& state, int w, Workspace& work);
void limit(const World& world, State& state, int w);
void integrate(const World& world, State& state, int w);
/// Push overlapping bodies apart (`collision_mode: contact`).
void push_apart(const World& world, State& state, int w, Workspace& work);
void finish(const World& world, State& state, int w);
/// Put objects whose time has come at their starts, in their order, each as soon as its place is free; replayed
/// recordings do not wait.
void appear(const World& world, State& state, int w);
/// Take objects whose time is over out of the world.
void vanish(const World& world, State& state, int w);
void collide(const World& world, State& state, int w);
void arrive(const World& world, State& state, int w);
void sense(const World& world, State& state, int w, Workspace& work);
/// Log who enters, leaves or crosses a zone, and who comes into or goes out of a watched field of view.
void watch(const World& world, State& state, int w, Workspace& work);

/// Find the contacts of a pair of objects a < b within the step, and keep it in `Scene::meetings`. They are apart at
/// its end.
void meet(const World& world, State& state, int w, int a, int b);
/// Where contacts within a step count as collisions (`world.contacts: swept`): find them among the pairs in
/// `Scene::near`, and put objects that stop at a collision back to where they first touched something.
void judge(const World& world, State& state, int w);
/// Log the meetings of the step, and count them for each object.
void log_meetings(const World& world, State& state, int w);
/// Place the geometry of the moving objects at their present poses.
void place_moving(const World& world, State& state, int w);
/// One period. With `external` the caller has moved the objects already.
void step(const World& world, State& state, int w, Workspace& work, bool external);
/// Whether every robot of world w has stopped or arrived; always false for a world without robots.
bool done(const World& world, const State& state, int w);

/// The phases for a single object.
void decide(const World& world, State& state, int w, Workspace& work, int object);
void limit(const World& world, State& state, int w, int object);
void integrate(const World& world, State& state, int w, int object);
/// Find out what the ground does to the wheels of a row in this step.
void feel_ground(const World& world, State& state, int row);
/// Give a wandering object a new random goal and a looping one its initial goals; a single goal alternates with the
/// start.
void renew_goals(const World& world, State& state, int w, int object);
/// Take a row out of the world, until `appear` puts it at its start.
void leave_world(State& state, int row);
/// Append the present pose of a row to its history.
void remember(State& state, int row);

/// Command an object to follow a world-frame velocity, as for a behavior that wants it.
void command_velocity(const World& world, State& state, int w, int object, Vec2 velocity, const Turning& turning);
/// The control with which `object` realises a world-frame velocity.
Vec3 control_for(const World& world, const State& state, int w, int object, Vec2 velocity, const Turning& turning);

}  // namespace irsim
