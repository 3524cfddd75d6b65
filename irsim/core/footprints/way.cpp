// Where an object with `footprint_orca` wants to go.
#include <algorithm>

#include "footprints/decider.hpp"
#include "random.hpp"

namespace irsim {
namespace {

constexpr double kLane = 0.02;             // clearance of a straight lane on either side [m]
constexpr double kSearchAgain = 3.0;       // time after which a way that is not open is searched again [s]
constexpr double kGoOn = 1.0;              // the same at the end of one that does not lead to the goal [s]
constexpr double kAtEnd = 0.5;             // distance from this end [m]
constexpr double kTight = 0.06;            // overlap with a lane that is tried if there is no other way [m]
constexpr double kHorizon = 8.0;           // ways are planned no farther ahead [m]
constexpr double kInside = 0.02;           // depth within `goal_threshold` to which a way leads [m]
constexpr double kWayCornerReached = 0.1;  // distance at which a corner of a way is left behind [m]
constexpr double kStayingDistance = 0.3;   // an object that stays within this distance makes no progress [m]
constexpr double kStayingTime = 1.2;       // time without progress, besides that for gathering speed, after which it
                                           // tries other directions [s]
constexpr double kTrial = 1.0;             // time for which it tries one, and then its own again [s]
constexpr double kLeastTrial = kPi / 3;    // smallest angle of such a direction from its own [rad]
constexpr double kMakeRoom = 0.3;          // gap at which an arrived object makes room for the rest [m]
constexpr double kStanding = 0.1;          // others that are slower are in the way of an object without progress [m/s]

/// Half the width of the lane in which a body moves [m].
double half_lane(const FootprintSelf& self) {
  const Vec2 left{-self.heading.y, self.heading.x};
  double most = 0.0;
  for (int k = 0; k < self.hull.count; ++k) {
    const Vec2 corner = self.hull.corner[k] - self.position;
    most = std::max(most, self.slides ? squared(corner) : std::fabs(dot(left, corner)));
  }
  return (self.slides ? std::sqrt(most) : most) + self.hull.round + kLane;
}

/// Radius of the disc that stands for the body on its way, and how far it may overlap what stands [m].
struct Lane {
  double radius, overlap;
};
Lane lane_of(const FootprintSelf& self, const Detour& detour) {
  const double half = half_lane(self);
  const double radius = detour.wide && self.turn_rate > 0.0 ? std::max(half, self.reach + kLane) : half;
  return {radius, radius - half + kTight};
}

/// Whether a way must be searched though all of it is open.
bool is_spent(const FootprintSelf& self, const Detour& detour, double age) {
  if (detour.planned < 0) return true;
  if (detour.points.empty() || age >= kSearchAgain)
    return age >= kSearchAgain && (detour.points.empty() || !detour.leads);
  return !detour.leads && age >= kGoOn && squared(detour.points.back() - self.position) < kAtEnd * kAtEnd;
}

/// Search a way if it is missing, old or blocked.
void update_way(FootprintSelf& self, Detour& detour, Vec2 to, double reach, Lane lane, std::int64_t now) {
  const std::vector<Blocker>& blockers = self.crowd.blockers;
  const int count = static_cast<int>(blockers.size());
  const double age = (now - detour.planned) * self.world().step_time;
  const bool old = age >= kSearchAgain;
  bool search = is_spent(self, detour, age);
  if (!search && (old || detour.blockers != count)) {
    Vec2 from = self.position;
    for (std::size_t k = detour.next; k < detour.points.size() && !search; ++k) {
      search = !is_open(from, detour.points[k], lane.radius, blockers);
      from = detour.points[k];
    }
    detour.blockers = count;
    if (old) detour.planned = now;
  }
  if (!search) return;
  detour.leads =
      find_detour(self.position, to, reach, lane.radius, lane.overlap, blockers, self.crowd.search, detour.points);
  detour.planned = now, detour.blockers = count, detour.next = 0;
}

/// The point to head for: the goal, or the next corner of a way round what stands.
Vec2 next_point(FootprintSelf& self, Detour& detour, Vec2 goal, std::int64_t now) {
  const std::vector<Blocker>& blockers = self.crowd.blockers;
  if (blockers.empty()) return goal;
  const Vec2 way = goal - self.position;
  const double distance = norm(way);
  const Lane lane = lane_of(self, detour);
  double reach = std::max(0.0, self.world().goal_threshold[self.object] - kInside);
  Vec2 to = goal;
  const bool far = distance > kHorizon;
  if (far) to = self.position + way * (kHorizon / distance), reach = std::max(reach, 1.0);
  const double left = norm(to - self.position);
  const Vec2 end = left > reach ? self.position + way * ((left - reach) / distance) : self.position;
  if (is_open(self.position, end, lane.radius, blockers)) {
    detour.points.clear(), detour.planned = -1;
    return goal;
  }
  update_way(self, detour, to, reach, lane, now);
  if (far) detour.leads = false;
  if (detour.points.empty()) return goal;
  const std::size_t last = detour.points.size() - 1;
  while (detour.next < last &&
         (squared(detour.points[detour.next] - self.position) < kWayCornerReached * kWayCornerReached ||
          is_open(self.position, detour.points[detour.next + 1], lane.radius, blockers))) {
    ++detour.next;
  }
  return detour.points[detour.next];
}

/// Time in which an object gathers its speed [s].
double time_to_speed(const FootprintSelf& self) {
  const double acce = self.state().acce[self.row][0];
  return acce > 0.0 ? self.speed / acce : 0.0;
}

/// An object without progress goes round others that stand, too.
void add_standing(FootprintSelf& self) {
  for (const int m : self.crowd.others) {
    const int row = self.decision.first_row + self.world().moving[m];
    if (self.state().stopped[row] || self.state().arrived[row]) continue;
    const OrcaAgent& other = self.all.movers[m];
    if (squared(other.velocity) >= kStanding * kStanding) continue;
    self.crowd.blockers.push_back({self.crowd.hulls[m], other.position, other.radius});
  }
}

/// Away from objects near one that has arrived and are still on their way.
Vec2 make_room(const FootprintSelf& self) {
  Vec2 push;
  for (const int m : self.crowd.others) {
    const int row = self.decision.first_row + self.world().moving[m];
    if (self.state().arrived[row] || self.state().stopped[row] || std::isnan(self.state().goal[row].x)) continue;
    const Separation apart = separation(self.hull, self.crowd.hulls[m]);
    if (apart.gap < kMakeRoom) push = push + apart.axis * (1.0 - std::max(0.0, apart.gap) / kMakeRoom);
  }
  return push * (self.speed / std::max(1.0, norm(push)));
}

}  // namespace

Vec2 wanted_velocity(FootprintSelf& self) {
  const World& world = self.world();
  const State& state = self.state();
  if (std::isnan(state.goal[self.row].x)) return {};
  if (state.arrived[self.row]) {
    const Vec2 push = make_room(self);
    if (squared(push) > 0.0) return push;
  }
  const Vec2 goal = state.destination(self.row).position();
  const double left = norm(goal - self.position), dt = world.step_time;
  if (!(left > 0.0 && left >= world.goal_threshold[self.object])) return {};
  Detour& detour = self.decision.detours[self.row];
  const std::int64_t now = state.count[self.decision.w()];
  if (detour.step != now - 1 && detour.step != now) detour = {};
  if (detour.step < 0 || squared(detour.goal - goal) > 0.0)
    detour.points.clear(), detour.planned = -1, detour.goal = goal, detour.wide = false;
  detour.step = now;
  if (detour.anchored < 0 || squared(detour.anchor - self.position) > kStayingDistance * kStayingDistance)
    detour.anchor = self.position, detour.anchored = now;
  const double waited = (now - detour.anchored) * dt - kStayingTime - time_to_speed(self);
  if (waited >= 0.0) add_standing(self);
  if (waited >= 0.0 && !detour.wide) detour.wide = true, detour.planned = -1;
  const Vec2 way = next_point(self, detour, goal, now) - self.position;
  const double distance = norm(way);
  if (!(distance > 0.0)) return {};
  const Vec2 wanted = way * (std::min(self.speed, left / dt) / distance);
  const auto trial = static_cast<std::int64_t>(std::floor(waited / kTrial));
  if (waited < 0.0 || trial % 2 == 1) return wanted;
  const Draws draws(state.key(self.decision.w()), Stream::behavior, world.number[self.object]);
  const auto u = draws.uniforms(static_cast<std::uint64_t>(detour.anchored) << 32 | static_cast<std::uint32_t>(trial));
  return rotate(wanted, unit((u[0] < 0.5 ? -1.0 : 1.0) * (kLeastTrial + u[1] * (kPi - kLeastTrial))));
}

}  // namespace irsim
