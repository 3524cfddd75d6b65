// Steps in which fast bodies meet something are divided, so that nothing passes through a body.
#pragma once

#include "contact/push.hpp"

namespace irsim {

/// Into how many parts a step must be divided: 1 unless a body would come out on the far side of another one that it
/// meets, or be pushed out on the far side of a third one. Jams, in which bodies come out where they went in, are not
/// divided.
int parts_of_step(const World& world, State& state, int w, Workspace& work);
/// Move all objects of a world through the step part by part, and push overlapping bodies apart after each part.
/// Contacts change the velocity of a body, and so the rest of its motion.
void push_in_parts(const World& world, State& state, int w, Workspace& work, const Resolution& options, int parts);

}  // namespace irsim
