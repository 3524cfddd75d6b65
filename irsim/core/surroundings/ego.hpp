// An object's knowledge of itself and its surroundings when its behavior decides.
#pragma once

#include "decision.hpp"

namespace irsim {

constexpr double kPadding = 0.1;  // margin added to every radius that behaviors see [m]

/// Object k of a decision, world frame.
struct Ego {
  int id, row;
  Vec2 position, velocity;  // origin [m], velocity of the present command at the present heading [m/s]
  Vec2 desired;             // toward the goal at full speed [m/s]; zero without a goal or within 0.1 m of it
  double radius;            // padded [m]
  const Route* route;       // route that the object follows, or null
  double pace;              // factor on the speeds that the options of a behavior give
};
Ego ego_of(const Decision& decision, int k);

/// Whether `ego` sees `other`: another object, either of a role that the behavior targets or a member of its group.
inline bool is_shown(const Decision& decision, int ego, int other) {
  const World& world = decision.world;
  if (other == ego) return false;
  if (has_role(world, world.target_roles[ego], other)) return true;
  return decision.grouped && world.group[other] == world.group[ego];
}

/// Call `visit(disc)`, by ascending id, for every other disc whose centre is nearer than `reach`. Radii have no margin.
/// Members of a group behavior know each other's origins, which are then the centres.
template <class Visit>
void for_discs(const Decision& decision, const Ego& ego, double reach, Visit&& visit) {
  const World& world = decision.world;
  const int w = decision.w();
  const Neighbors& near = neighbors(world, decision.state, decision.work, w);
  const Shapes& shapes = *decision.state.scenes[w].shapes;
  const double slack = decision.grouped ? std::max(near.off_centre, near.off_origin) : near.off_centre;
  const double reach2 = reach * reach;
  const auto* is_static = world.is_static.data();
  const Slot* placed = shapes.placed.data();
  const Disc* discs = near.discs.data();
  const bool sees_all = world.target_roles[ego.id] == 0, grouped = decision.grouped;
  const int self = ego.id;
  Disc copy{};
  for_neighbors(world, decision.state, decision.work, w, ego.position, reach + slack, [&](int other) {
    if (other == self || !(sees_all || is_shown(decision, self, other))) return;
    const Disc* disc = &copy;
    if (is_static[other]) {
      copy = disc_of(world, decision.state, decision.work, w, other);
    } else {
      disc = &discs[placed[other].object];
    }
    if (grouped && world.group[other] == world.group[self]) {
      copy = *disc, disc = &copy;
      copy.centre = decision.state.pose[decision.first_row + other].position();
    }
    if (squared(disc->centre - ego.position) < reach2) visit(*disc);
  });
}

/// Call `visit(a, b)` for the segments of all moving linestrings, at any distance.
template <class Visit>
void for_moving_lines(const Decision& decision, const Ego& ego, Visit&& visit) {
  const int w = decision.w();
  const Scene& scene = decision.state.scenes[w];
  for (const int object : neighbors(decision.world, decision.state, decision.work, w).lines) {
    if (!is_shown(decision, ego.id, object)) continue;
    const Shapes& shapes = *scene.shapes;
    const int row = decision.first_row + object;
    const Vec2 origin = decision.state.pose[row].position(), direction = decision.state.heading(row);
    const Part& part = shapes.parts[shapes.body[object].part];
    const Vec2* vertices = &shapes.vertices[shapes.body[object].vertex];
    for (int v = part.first; v < part.last; ++v) {
      visit(origin + rotate(vertices[v], direction), origin + rotate(vertices[v + 1], direction));
    }
  }
}

/// Call `visit(wall)`, by ascending index, for the walls within `reach` of `position` that face it and that object `id`
/// sees.
template <class Visit>
void for_facing_walls(const Decision& decision, int id, Vec2 position, double reach, Visit&& visit) {
  const Walls& walls = decision.state.scenes[decision.w()].fixed->walls;
  int ring = -1;
  bool seen = false;
  if (walls.list.empty()) return;
  walls.facing(position, reach, decision.work.walls);
  for (const int k : decision.work.walls.found) {
    const Wall& wall = walls.list[k];
    if (!is_shown(decision, id, wall.object)) continue;
    if (wall.ring != ring) ring = wall.ring, seen = walls.rings[ring].is_seen_from(position);
    if (seen) visit(wall);
  }
}

}  // namespace irsim
