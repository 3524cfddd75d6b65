// Closing in on others: in one step an object takes at most two fifths of the gap to any round body. Two that both come
// keep a fifth of it, so that they do not touch, whichever velocities they choose and however their drives turn.
#pragma once

#include <optional>
#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

struct Decision;
struct Disc;
struct Ego;
struct Intent;

/// A round body that one step could bring an object to.
struct Nearby {
  Vec2 towards;  // unit vector
  double gap;    // between both outlines, without a centimetre that is never taken [m], at least 0
};

/// Whether an object keeps gaps: robots do unless their behavior says otherwise.
bool keeps_gaps(const Decision& decision, const Ego& ego, std::optional<bool> chosen);

constexpr double kClosingShare = 0.4;  // of a gap that is taken in one step

/// Whether an object could take more than its share of a gap in one step.
///
/// Args:
///   way: From its centre to the centre of a round body [m].
///   touching: Distance of the centres at which they touch [m].
///   ahead: Gap of which the longest way of a step is the share [m].
inline bool may_close(Vec2 way, double touching, double ahead) {
  const double reach = touching + ahead;
  return squared(way) < reach * reach;
}

/// Add a disc whose gap the ego may close to `Workspace::nearby` if both bodies are circles: the discs of other bodies
/// are larger than they are.
void add_nearby(const Decision& decision, const Ego& ego, const Disc& disc);

/// Change what an object wants so that it takes no more than its share of any gap in `Workspace::nearby` in this step.
/// A drive that can move sideways slides along what is in its way; any other rolls no faster along its heading, and
/// turns to the direction in which it would slide if `slides`: a behavior that searches among velocities knows a better
/// one.
void keep_gaps(const Decision& decision, const Ego& ego, bool slides, Intent& intent);

}  // namespace irsim
