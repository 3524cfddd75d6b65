#include "surroundings/observe.hpp"

#include "collision/support.hpp"
#include "world/state.hpp"
#include "world/world.hpp"

namespace irsim {

Neighbor Observer::neighbor(int row, const BoundingCircle& circle) const {
  const double robot = world_.is_robot[row % world_.objects] ? 1.0 : 0.0, arrived = state_.arrived[row] ? robot : 0.0;
  const Vec3& twist = state_.twist[row];
  return {circle.centre, state_.pose[row].theta, state_.heading(row), {twist[0], twist[1]}, circle.radius, arrived,
          robot};
}

void Observer::measure_extents(int row, Vec2 place, int other, Neighbor& neighbor) const {
  const Vec2 away = neighbor.position - place;
  const double distance = norm(away);
  const Vec2 direction = distance > 0.0 ? away * (1.0 / distance) : Vec2{1.0, 0.0};
  const int w = row / world_.objects;
  neighbor.own_extent = reach_from(state_.footprint(world_, w, row % world_.objects), place, direction);
  neighbor.extent = reach_from(state_.footprint(world_, w, other), neighbor.position, direction * -1.0);
}

Seen Observer::see(int row, Near& near) const {
  const int w = row / world_.objects, object = row % world_.objects;
  const Vec3& twist = state_.twist[row];
  Seen seen;
  seen.pose = state_.pose[row];
  seen.ahead = state_.heading(row);
  seen.steering = looking_.steered[object] ? state_.extra[static_cast<std::size_t>(row) * state_.extra_rows] : 0.0;
  seen.velocity = {twist[0], twist[1]};
  seen.commanded = state_.commanded[row];
  seen.yaw_rate = twist[2];
  seen.control = state_.control[row];
  seen.low = state_.vel_min[row], seen.high = state_.vel_max[row];
  seen.goal = state_.goal[row];
  seen.goal_threshold = world_.goal_threshold[object];
  seen.radius = state_.radius[row];
  seen.arrived = state_.arrived[row] ? 1.0 : 0.0;
  near.neighbors.clear();
  if (looking_.neighbors > 0) {
    if (near.world != w) bounding_circles(world_, state_, w, near.circles);
    near.world = w;
    nearest_objects(world_, state_, near.circles, row, looking_.neighbors, looking_.reach, looking_.statics,
                    near.nearest);
    for (const int i : near.nearest.object) {
      near.neighbors.push_back(neighbor(w * world_.objects + i, near.circles[i]));
      if (looking_.extents) measure_extents(row, seen.pose.position(), i, near.neighbors.back());
    }
  }
  seen.neighbors = near.neighbors.data(), seen.neighbor_count = near.neighbors.size();
  if (looking_.beams > 0) {
    const std::size_t beam = static_cast<std::size_t>(w) * world_.beams_per_world + looking_.first_beam[object];
    seen.ranges = state_.ranges.data + beam;
    seen.beams = looking_.beams, seen.range_max = looking_.range_max;
  }
  return seen;
}

}  // namespace irsim
