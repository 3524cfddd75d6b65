#include "surroundings/perception.hpp"

#include <algorithm>
#include <stdexcept>
#include <variant>

#include "phases.hpp"
#include "world/features.hpp"
#include "world/spec.hpp"

namespace irsim {
namespace {

/// The gauge of an object with these options; null without one.
template <class Options>
const Scan* gauge_of(const World& world, int object) {
  for (const Scan& gauge : world.gauges) {
    if (gauge.mount.object == object && std::holds_alternative<Options>(gauge.sensor)) return &gauge;
  }
  return nullptr;
}

/// The readings of the world of a row.
const double* readings_of(const World& world, const State& state, int row) {
  return state.readings.data + static_cast<std::size_t>(row / world.objects) * world.readings_per_world;
}

}  // namespace

Perception perception_of(const World& world, int object, const ObjectSpec& spec) {
  Perception made;
  if (spec.perceives_estimate) {
    const Scan* source = gauge_of<LocalizationOptions>(world, object);
    if (source == nullptr) source = gauge_of<OdometryOptions>(world, object);
    if (source == nullptr) throw std::invalid_argument("an object without localization or odometry has no estimate");
    made.pose = source->mount.first_reading;
  }
  if (spec.perceives_tracks) {
    const Scan* source = gauge_of<DetectorOptions>(world, object);
    if (source == nullptr) throw std::invalid_argument("an object without a detector has no tracks");
    made.tracks = source->mount.first_reading, made.slots = source->mount.readings / kTrack;
  }
  return made;
}

bool believes(const World& world, int object) { return !world.perception.empty() && world.perception[object].any(); }

bool estimates(const World& world, int object) {
  return !world.perception.empty() && world.perception[object].pose >= 0;
}

Pose believed_pose(const World& world, const State& state, int row) {
  const int object = row % world.objects;
  if (!estimates(world, object)) return state.pose[row];
  const double* const read = readings_of(world, state, row) + world.perception[object].pose;
  return std::isfinite(read[0]) ? Pose{read[0], read[1], read[2]} : state.pose[row];
}

void believe(const World& world, const State& state, int row, Beliefs& out) {
  const Perception& perception = world.perception[row % world.objects];
  const Pose& truth = state.pose[row];
  out.pose = believed_pose(world, state, row);
  out.turn = unit(out.pose.theta - truth.theta);
  out.movers.clear();
  const int first = row - row % world.objects;
  for (std::size_t m = 0; m < world.moving.size(); ++m) {
    const Pose& pose = state.pose[first + world.moving[m]];
    const Vec2 place = out.pose.position() + rotate(pose.position() - truth.position(), out.turn);
    const bool present = perception.tracks < 0 && !state.absent(first + world.moving[m]);
    out.movers.push_back({present,
                          {place.x, place.y, wrap(pose.theta + out.pose.theta - truth.theta)},
                          rotate(out.velocities[m], out.turn)});
  }
  if (perception.tracks < 0) return;
  const double* const tracks = readings_of(world, state, row) + perception.tracks;
  const Vec2 ahead = unit(out.pose.theta);
  const auto follow = [&](Sighting& sighting, const double* track) {
    const Vec2 place = out.pose.position() + rotate(Vec2{track[kTrackX], track[kTrackY]}, ahead);
    sighting.present = true;
    sighting.pose.x = place.x, sighting.pose.y = place.y;
    sighting.velocity = rotate(Vec2{track[kTrackSpeedX], track[kTrackSpeedY]}, ahead);
  };
  std::vector<const double*>& strays = out.false_tracks;
  strays.clear();
  for (int k = 0; k < perception.slots; ++k) {
    const double* const track = tracks + static_cast<std::ptrdiff_t>(k) * kTrack;
    if (!std::isfinite(track[kTrackId])) continue;
    if (track[kTrackSource] < 0.0) strays.push_back(track);
    for (std::size_t m = 0; m < world.moving.size(); ++m) {
      if (world.moving[m] == track[kTrackSource]) follow(out.movers[m], track);
    }
  }
  const auto distance = [](const double* track) { return std::hypot(track[kTrackX], track[kTrackY]); };
  std::sort(strays.begin(), strays.end(), [&](const double* a, const double* b) { return distance(a) < distance(b); });
  std::size_t next = 0;
  for (std::size_t m = 0; m < world.moving.size() && next < strays.size(); ++m) {
    if (!out.movers[m].present && world.moving[m] != row % world.objects) follow(out.movers[m], strays[next++]);
  }
}

Belief::Belief(const World& world, State& state, int w, int object, Workspace& work, Replaced& replaced)
    : world_(world),
      state_(state),
      row_(w * world.objects + object),
      work_(work),
      replaced_(replaced),
      active_(believes(world, object)) {
  if (!active_) return;
  const int first = w * world.objects;
  Beliefs& beliefs = replaced.beliefs;
  work.forget_step();
  beliefs.velocities.clear();
  for (const Disc& disc : neighbors(world, state, work, w).discs) beliefs.velocities.push_back(disc.velocity);
  believe(world, state, first + object, beliefs);
  replaced.pose.clear(), replaced.twist.clear(), replaced.appeared.clear();
  for (std::size_t m = 0; m < world.moving.size(); ++m) {
    const int row = first + world.moving[m];
    Vec3& twist = state.twist[row];
    replaced.pose.push_back(state.pose[row]);
    replaced.twist.push_back(twist);
    replaced.appeared.push_back(state.appeared[row]);
    const bool itself = world.moving[m] == object;
    const Sighting& sighting = beliefs.movers[m];
    const Vec2 velocity = itself ? rotate(Vec2{twist[0], twist[1]}, beliefs.turn) : sighting.velocity;
    state.pose[row] = itself ? beliefs.pose : sighting.pose;
    twist[0] = velocity.x, twist[1] = velocity.y;
    if (itself) continue;
    if (!sighting.present) state.pose[row].x = state.pose[row].y = kNone;
    if (sighting.present != !state.absent(row)) state.appeared[row] = sighting.present ? 0 : -1;
  }
  replaced.arrived = state.arrived[first + object];
  if (estimates(world, object)) state.arrived[first + object] = state.believes_arrived[first + object];
  work.forget_step();
  place_moving(world, state, w);
  neighbors(world, state, work, w);
  for (std::size_t m = 0; m < world.moving.size(); ++m) {
    if (world.moving[m] != object) work.neighbors.discs[m].velocity = beliefs.movers[m].velocity;
  }
}

Belief::~Belief() {
  if (!active_) return;
  const int w = row_ / world_.objects;
  for (std::size_t m = 0; m < world_.moving.size(); ++m) {
    const int row = w * world_.objects + world_.moving[m];
    state_.pose[row] = replaced_.pose[m], state_.twist[row] = replaced_.twist[m];
    state_.appeared[row] = replaced_.appeared[m];
  }
  state_.arrived[row_] = replaced_.arrived;
  place_moving(world_, state_, w);
  work_.forget_step();
}

}  // namespace irsim
