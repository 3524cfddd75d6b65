#include "surroundings/passing.hpp"

#include <algorithm>

#include "surroundings/wall_view.hpp"
#include "world/scene.hpp"

namespace irsim {
namespace {

constexpr double kClearance = 0.02;      // distance kept from walls in addition [m]
constexpr double kSmallestPart = 0.125;  // of the distance to walls, the last that is tried
constexpr double kLeastAhead = 0.01;     // smallest cosine of a turn
constexpr double kTie = 1e-9;            // ways whose lengths differ by less are equal [m]
constexpr int kMostTurns = 8;            // rings that one turn can lead past

/// A way past what is ahead: its first direction, and its length over the last corner to the goal.
struct Way {
  Vec2 direction;
  double length = kInfinity;  // infinite if there is no way [m]
};

/// Turn a unit vector to one side until nothing is in the way within `share` of the distance.
Way turn_past(const WallView& view, Vec2 ahead, Vec2 goal, bool to_the_left, double share) {
  Way way{ahead};
  double length = norm(goal);
  for (int turns = 0; turns < kMostTurns; ++turns) {
    const Front* front = view.in_the_way(way.direction, share);
    if (front == nullptr) {
      way.length = length;
      return way;
    }
    const HullTangents& tangents = front->tangents;
    const Vec2 edge = to_the_left ? tangents.left : tangents.right;
    const Vec2 corner = to_the_left ? tangents.left_corner : tangents.right_corner;
    const double further = cross(way.direction, edge);
    if ((to_the_left ? further <= 0.0 : further >= 0.0) || dot(edge, ahead) < kLeastAhead) return way;
    way.direction = edge;
    length = norm(corner) + norm(goal - corner);
  }
  return way;
}

}  // namespace

Vec2 past_rings(const Decision& decision, int k, Vec2 position, double radius, double look, Vec2 wanted, bool all) {
  const int row = decision.row(k);
  const double speed = norm(wanted);
  if (!(speed > 0.0) || decision.state.route_of(row) != nullptr) return wanted;
  const Vec2 goal = decision.state.destination(row).position() - position;
  WallView& view = decision.work.wall_view;
  view.clear();
  add_walls(decision, decision.objects[k], position, radius, 0.0, std::min(look, norm(goal)), kClearance, all, view);
  if (!view.passable) return wanted;
  const Vec2 ahead = wanted * (1.0 / speed);
  for (double share = 1.0; share >= kSmallestPart; share *= 0.5) {
    if (view.in_the_way(ahead, share) == nullptr) return wanted;
    const Way left = turn_past(view, ahead, goal, true, share), right = turn_past(view, ahead, goal, false, share);
    if (std::min(left.length, right.length) < kInfinity)
      return (left.length < right.length - kTie ? left : right).direction * speed;
  }
  return wanted;
}

bool is_free_ahead(const Decision& decision, int k, Vec2 position, double radius, double look, Vec2 ahead) {
  WallView& view = decision.work.wall_view;
  view.clear();
  add_walls(decision, decision.objects[k], position, radius, look + radius, 0.0, 0.0, true, view);
  return std::all_of(view.barriers.begin(), view.barriers.end(),
                     [&](const Barrier& wall) { return wall.time(ahead) >= look; });
}

}  // namespace irsim
