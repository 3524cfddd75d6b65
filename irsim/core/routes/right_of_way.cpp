#include "routes/right_of_way.hpp"

#include "routes/extents.hpp"
#include "routes/follower.hpp"
#include "routes/sides.hpp"
#include "world/features.hpp"

namespace irsim {
namespace {

constexpr double kProgress = 0.05;           // shortening of the way ahead that counts as progress [m]
constexpr double kPatience = 1.0;            // an object without progress for this time is held up [s]
constexpr double kDetour = 0.5;              // a way ahead that grew by more belongs to another path [m]
constexpr double kRecovery = 2.0;            // an object without progress for this time tries another way [s]
constexpr double kNear = 0.6;                // distance to those who are in the way [m]
constexpr double kTrackStep = 0.1;           // distance between the poses of the track [m]
constexpr double kTrackTurn = 0.15;          // turn between the poses of the track [rad]
constexpr std::size_t kTrackLength = 100;    // poses of the track
constexpr int kMaxPosesAmongOthers = 15000;  // poses after which a plan among others is given up
constexpr double kRetreat = 1.2;             // length of a retreat [m]
constexpr double kWait = 3.0;                // time that an object waits after its retreat [s]
constexpr double kInsistTime = 10.0;         // time for which an object that could not retreat goes first [s]
constexpr double kInsistence = 1e6;          // by how much shorter its way counts [m]

/// Way that is left to the goal [m]. Objects that have arrived or have no way give way to all others.
double way_ahead(const State& state, int row, std::int64_t now) {
  const Route& route = state.routes[row];
  if (state.arrived[row] || route.path.empty()) return kInfinity;
  return route.way_ahead - (now < route.insists_until ? kInsistence : 0.0);
}

/// Whether an object goes before another: the one with the shorter way, or else the one farther to the left, or down.
bool goes_first(const State& state, int a, int b) {
  const RightOfWay &one = state.routes[a].right_of_way, &two = state.routes[b].right_of_way;
  const Pose &here = state.pose[a], &there = state.pose[b];
  if (one.way != two.way) return one.way < two.way;
  if (one.yielded != two.yielded) return one.yielded < two.yielded;
  if (here.x != there.x) return here.x < there.x;
  return here.y != there.y ? here.y < there.y : a < b;
}

}  // namespace

bool follows_route(const World& world, const State& state, int w, int object) {
  const int row = w * world.objects + object;
  return world.specs[object].route && !world.is_static[object] && !state.stopped[row] && !state.given[row] &&
         !state.waits(row);
}

Precedence precedence(const World& world, const State& state, int w, int object, int other) {
  if (state.routes.empty() || !follows_route(world, state, w, object) || !follows_route(world, state, w, other))
    return Precedence::shared;
  const int a = w * world.objects + object, b = w * world.objects + other;
  if (!state.routes[a].right_of_way.held_up && !state.routes[b].right_of_way.held_up) return Precedence::shared;
  return goes_first(state, a, b) ? Precedence::first : Precedence::second;
}

void publish_rights_of_way(const World& world, State& state, int w) {
  const int first = w * world.objects;
  const auto backs_up = [&](int row) {
    return state.routes[row].retreats && !state.routes[row].legs.empty() && state.routes[row].lets_pass >= 0;
  };
  for (const int i : world.routed) {
    Route& route = state.routes[first + i];
    int origin = i;
    route.right_of_way = {};
    while (backs_up(first + origin) && route.right_of_way.yielded <= static_cast<int>(world.routed.size()))
      origin = state.routes[first + origin].lets_pass, ++route.right_of_way.yielded;
    route.right_of_way.way = way_ahead(state, first + origin, state.count[w]);
    route.right_of_way.held_up = route.held_up && !state.arrived[first + i];
    const bool waits = state.arrived[first + i] || (route.retreats && route.legs.empty());
    route.right_of_way.held = waits ? 0 : state.count[w] - route.progress_at;
  }
}

void Follower::track_progress() {
  if (route_.retreats) return;
  double left = 0.0;
  Vec2 from = position();
  if (route_.legs.empty()) {
    for (std::size_t k = route_.next; k < route_.path.size(); ++k) {
      left += norm(route_.path[k] - from);
      from = route_.path[k];
    }
  } else {
    for (std::size_t k = route_.leg; k < route_.legs.size(); ++k) {
      left += norm(route_.legs[k].pose.position() - from);
      from = route_.legs[k].pose.position();
    }
  }
  route_.way_ahead = left;
  const std::int64_t now = state_.count[w_];
  if (!(left >= route_.shortest_way - kProgress) || left > route_.shortest_way + kDetour || state_.arrived[row_])
    route_.shortest_way = left, route_.progress_at = now;
  route_.held_up = static_cast<double>(now - route_.progress_at) * world_.step_time >= kPatience;
}

void Follower::keep_track() {
  std::vector<Leg>& track = route_.track;
  const Pose& pose = state_.pose[row_];
  const double speed = state_.control[row_][0];
  if (!track.empty()) {
    const Pose& last = track.back().pose;
    const bool moved = norm(pose.position() - last.position()) >= kTrackStep;
    if (!moved && std::fabs(wrap(pose.theta - last.theta)) < kTrackTurn) return;
    if (track.size() == kTrackLength) track.erase(track.begin());
    // Where the object comes back to its track, it need not drive the loop again.
    for (std::size_t k = 0; k + 1 < track.size(); ++k) {
      const Pose& old = track[k].pose;
      if (norm(pose.position() - old.position()) < kTrackStep && std::fabs(wrap(pose.theta - old.theta)) < kTrackTurn)
        return track.resize(k + 1);
    }
    track.push_back({pose, moved ? (speed < 0.0 ? -1 : 1) : 0});
  } else {
    track.push_back({pose, 1});
  }
}

bool Follower::retreat(int other) {
  const std::vector<Leg>& track = route_.track;
  if (track.size() < 2 || !(state_.vel_min[row_][0] < 0.0)) return false;
  route_.legs = {{state_.pose[row_], 0}};
  double length = 0.0;
  for (std::size_t k = track.size(); k-- > 1 && length < kRetreat;) {
    length += norm(track[k - 1].pose.position() - track[k].pose.position());
    route_.legs.push_back({track[k - 1].pose, -track[k].way});
  }
  route_.retraced = route_.legs.size() - 1;
  route_.leg = 1;
  route_.blocked_steps = 0;
  route_.retreats = true;
  route_.lets_pass = other;
  route_.wait_until =
      state_.count[w_] + static_cast<std::int64_t>((kRetreat / top_speed(-1) + kWait) / world_.step_time);
  return true;
}

void Follower::forget_retreat() {
  if (!route_.retreats) return;
  route_.retreats = false;
  // The stretch that was driven back is no longer a part of the track.
  const std::size_t driven = route_.legs.empty() ? route_.retraced : route_.leg - 1;
  route_.track.resize(route_.track.size() - std::min(driven, route_.track.size() - 1));
}

bool Follower::plan_among_others() {
  std::vector<Footprint> others = avoided_;
  for (const int i : world_.moving) {
    if (i != object_ && !world_.unobstructed[i] && !state_.absent(w_ * world_.objects + i))
      others.push_back(state_.scenes[w_].moving.footprint(shapes_, i));
  }
  const Route before = route_;
  blockers_.others = &others;
  route_.path.clear();
  route_.next = 1;
  const bool found = find_legs(extent_of(shapes_, object_).reach, kMaxPosesAmongOthers);
  mind_avoided(true);
  if (!found) {
    route_ = before;
    return false;
  }
  route_.uncertain = false;
  route_.planned_at = state_.count[w_];
  return true;
}

void Follower::recover() {
  const bool turns_round =
      steers(world_.drive[object_]) || (turns_in_place(world_.drive[object_]) && !route_.legs.empty());
  if (!turns_round || std::holds_alternative<DashOptions>(world_.specs[object_].behavior)) return;
  if (route_.retreats) {
    if (state_.count[w_] < route_.wait_until) return;
    const bool blocked = !route_.legs.empty();
    plan();
    if (blocked) route_.insists_until = state_.count[w_] + static_cast<std::int64_t>(kInsistTime / world_.step_time);
    return;
  }
  keep_track();
  const auto patience = std::max<std::int64_t>(1, static_cast<std::int64_t>(kRecovery / world_.step_time));
  const Footprint body = state_.scenes[w_].moving.footprint(shapes_, object_);
  bool near = false;
  for (const int other : world_.routed) {
    if (other == object_ || !follows_route(world_, state_, w_, other)) continue;
    const Footprint there = state_.scenes[w_].moving.footprint(shapes_, other);
    Vec2 normal;
    if (norm(there.centre - body.centre) > body.radius + there.radius + kNear ||
        widest_strip(body, there, normal) > kNear)
      continue;
    near = true;
    const std::int64_t held = state_.routes[w_ * world_.objects + other].right_of_way.held;
    if (held > 0 && held % patience == 0 && precedence(world_, state_, w_, object_, other) == Precedence::second &&
        retreat(other))
      return;
  }
  // Searching takes long, so the second search comes after twice the time, the third after four times, and so on.
  const std::int64_t held = route_.right_of_way.held, times = held / patience;
  if (held <= 0 || held % patience != 0) return;
  if (!near && !route_.legs.empty()) return plan();
  if (near && (times & (times - 1)) == 0) plan_among_others();
}

}  // namespace irsim
