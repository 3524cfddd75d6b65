#include "surroundings/observe.hpp"

#include <algorithm>

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

void Observer::find_believed(int row, Near& near) const {
  const int w = row / world_.objects, object = row % world_.objects;
  near.world = -1;
  bounding_circles(world_, state_, w, near.circles);
  const Shapes& shapes = *state_.scenes[w].shapes;
  for (std::size_t m = 0; m < world_.moving.size(); ++m) {
    const int i = world_.moving[m];
    const Sighting& sighting = near.beliefs.movers[m];
    const Pose& pose = i == object ? near.beliefs.pose : sighting.pose;
    const bool present = i == object || sighting.present;
    near.circles[i].centre =
        present ? pose.position() + rotate(shapes.centre[i], unit(pose.theta)) : Vec2{kNone, kNone};
  }
  nearest_objects(world_, state_, near.circles, row, looking_.neighbors, looking_.reach, looking_.statics,
                  near.nearest);
}

void Observer::measure_extents(int row, int other, Neighbor& neighbor) const {
  const int w = row / world_.objects, other_row = row - row % world_.objects + other;
  const Vec2 place = state_.pose[row].position(), offset = state_.scenes[w].shapes->centre[other];
  const Vec2 there = state_.pose[other_row].position() + rotate(offset, state_.heading(other_row));
  const Vec2 away = there - place;
  const double distance = norm(away);
  const Vec2 direction = distance > 0.0 ? away * (1.0 / distance) : Vec2{1.0, 0.0};
  neighbor.own_extent = reach_from(state_.footprint(world_, w, row % world_.objects), place, direction);
  neighbor.extent = reach_from(state_.footprint(world_, w, other), there, direction * -1.0);
}

Seen Observer::see(int row, Near& near) const {
  const int w = row / world_.objects, object = row % world_.objects;
  const Vec3& twist = state_.twist[row];
  const bool believing = believes(world_, object);
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
  seen.arrived = (estimates(world_, object) ? state_.believes_arrived : state_.arrived)[row] ? 1.0 : 0.0;
  if (believing) {
    near.beliefs.velocities.clear();
    for (const int i : world_.moving) {
      const Vec3& other = state_.twist[row - object + i];
      near.beliefs.velocities.push_back({other[0], other[1]});
    }
    believe(world_, state_, row, near.beliefs);
    seen.pose = near.beliefs.pose, seen.ahead = unit(seen.pose.theta);
    seen.velocity = rotate(seen.velocity, near.beliefs.turn);
  }
  near.neighbors.clear();
  if (looking_.neighbors > 0) {
    if (believing) {
      find_believed(row, near);
    } else {
      if (near.world != w) bounding_circles(world_, state_, w, near.circles);
      near.world = w;
      nearest_objects(world_, state_, near.circles, row, looking_.neighbors, looking_.reach, looking_.statics,
                      near.nearest);
    }
    for (const int i : near.nearest.object) {
      near.neighbors.push_back(neighbor(w * world_.objects + i, near.circles[i]));
      Neighbor& other = near.neighbors.back();
      if (looking_.extents) measure_extents(row, i, other);
      if (!believing || world_.is_static[i]) continue;
      const auto found = std::lower_bound(world_.moving.begin(), world_.moving.end(), i);
      const Sighting& sighting = near.beliefs.movers[static_cast<std::size_t>(found - world_.moving.begin())];
      other.heading = sighting.pose.theta, other.ahead = unit(other.heading), other.velocity = sighting.velocity;
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
