// Bodies that would be pushed, or would move on, through the middle of another body are held where the two met.
#pragma once

#include <vector>

#include "contact/push.hpp"

namespace irsim {

/// How the moving objects went through a step or a part of one, by their slots in `Outlines`: from these poses, turning
/// by about this much [rad].
struct Begun {
  const std::vector<Pose>& from;
  const std::vector<double>& turn;
  int parts;  // of the whole step
};

/// Push overlapping bodies apart where their motion ended. Bodies whose cores would have gone through each other, or
/// through one that cannot be pushed, are put back to where these met, and are pushed apart from there.
void push_and_hold(const World& world, State& state, int w, Workspace& work, const Resolution& options,
                   const Begun& begun);

/// Add the contacts of a part of a step to all of them, which are sorted by objects. `share` is the share of the part
/// in the mean force of the step.
void merge_contacts(std::vector<Contact>& all, const std::vector<Contact>& now, double share);

}  // namespace irsim
