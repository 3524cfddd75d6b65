#include "routes/route.hpp"

#include "collision/touch.hpp"
#include "routes/follower.hpp"
#include "routes/right_of_way.hpp"
#include "world/features.hpp"

namespace irsim {
namespace {

constexpr double kCornerReached = 0.05;       // a corner this near counts as reached [m]
constexpr double kMinTimeBetweenPlans = 1.0;  // after a plan, before another is made because the path was lost [s]

}  // namespace

void Follower::follow_route() {
  if (std::isnan(state_.goal[row_].x)) return;
  if (plan_is_due()) plan();
  if (parking_is_due()) plan_parking();
  if (route_.path.empty()) return;
  if (route_.legs.empty() && !route_.retreats) advance();
  track_progress();
}

void Follower::update_target() {
  const Goal& goal = state_.goal[row_];
  Goal& target = state_.target[row_];
  target = goal;
  if (std::isnan(goal.x)) return;
  if (!route_.path.empty()) go_round_parked();
  if (!route_.path.empty()) recover();
  if (route_.path.empty() || (route_.retreats && route_.legs.empty())) {
    target.x = target.y = kNone;
    return;
  }
  if (!route_.legs.empty()) {
    const Vec2 point = route_.legs[route_.leg].pose.position();
    target = {point.x, point.y, kNone};
    return;
  }
  if (route_.next + 1 == route_.path.size() && !(options_.lookahead > 0.0)) return;
  aim(target);
}

void Follower::adjust_command() { adjust(state_.command[row_]); }

void Follower::adjust(Vec3& u) {
  if (std::isnan(state_.goal[row_].x)) return;
  const bool waits = route_.retreats && route_.legs.empty();
  if (route_.path.empty() || waits || (parks() && route_.legs.empty() && state_.arrived[row_])) return brake(u);
  mind_avoided(!is_in_avoided());
  measure_gap();
  if (!route_.legs.empty()) {
    follow_legs(u);
    if (!route_.legs.empty()) return keep_apart(u);
    if (route_.path.empty()) return brake(u);  // the legs are blocked, and no other path was found
  }
  if (route_.uncertain || parks()) report_if_stuck();
  if (std::holds_alternative<DashOptions>(world_.specs[object_].behavior)) steer_to_corner(u);
  if (route_.keeps_heading) u[2] = 0.0;
  slow_down_to_goal(u);
  back_off_from_goal();
  keep_clear(u);
  keep_apart(u);
}

Vec2 Follower::position() const { return state_.pose[row_].position(); }

bool Follower::is_in_avoided() const {
  if (avoided_.empty()) return false;
  const Footprint body = state_.scenes[w_].moving.footprint(shapes_, object_);
  return std::any_of(avoided_.begin(), avoided_.end(),
                     [&](const Footprint& zone) { return body.box.meets(zone.box) && touch(body, zone); });
}

bool Follower::sees(std::size_t body, Vec2 from, Vec2 to) {
  if (Space{blockers_, route_.bodies[body], bounds(), false, region()}.clear(from, to)) return true;
  if (body != 1 || !is_in_avoided()) return false;
  // An object in a zone that it avoids heads on for its corner, which lies outside.
  Blockers solid = blockers_;
  solid.others = nullptr;
  return Space{solid, route_.bodies[body], bounds(), false, region()}.clear(from, to);
}

void Follower::advance() {
  const Vec2 here = position();
  const std::vector<Vec2>& path = route_.path;
  const double stride =
      std::max(kCornerReached, 0.5 * norm({state_.twist[row_][0], state_.twist[row_][1]}) * world_.step_time);
  std::size_t& next = route_.next;
  while (next + 1 < path.size() && (norm(path[next] - here) <= stride || sees(0, here, path[next + 1]))) ++next;
  if (sees(1, here, path[next])) return;
  // The object was pushed aside: it returns to a corner in sight, or else plans a new path.
  for (std::size_t k = next; k-- > 1;) {
    if (sees(1, here, path[k])) {
      next = k;
      return;
    }
  }
  const double age = static_cast<double>(state_.count[w_] - route_.planned_at) * world_.step_time;
  if (age < kMinTimeBetweenPlans) return;
  const std::vector<Vec2> old = path;
  plan();
  if (route_.path.empty()) route_.path = old, route_.next = std::min(next, old.size() - 1);
}

void Follower::aim(Goal& target) {
  const Vec2 here = position();
  Vec2 point = route_.path[route_.next];
  if (options_.lookahead > 0.0) {
    double left = options_.lookahead;
    Vec2 from = here, ahead = route_.path.back();
    for (std::size_t k = route_.next; k < route_.path.size(); ++k) {
      const double length = norm(route_.path[k] - from);
      if (length >= left && length > 0.0) {
        ahead = from + (route_.path[k] - from) * (left / length);
        break;
      }
      left -= length;
      from = route_.path[k];
    }
    if (sees(0, here, ahead)) point = ahead;
    if (norm(point - route_.path.back()) == 0.0) return;
  }
  const Vec2 way = point - here;
  const double distance = norm(way), min_distance = 2.0 * world_.goal_threshold[object_] + 0.2;
  if (distance > 0.0 && distance < min_distance) point = here + way * (min_distance / distance);
  target = {point.x, point.y, kNone};
}
void find_routes(const World& world, State& state, int w, Workspace& work, int only) {
  if (world.routed.empty()) return;
  const int first = w * world.objects;
  for (int i = 0; i < world.objects; ++i) state.target[first + i] = state.goal[first + i];
  const auto for_each = [&](auto&& act) {
    for (const int i : world.routed) {
      if ((only >= 0 && only != i) || !follows_route(world, state, w, i)) continue;
      const Belief belief(world, state, w, i, work, work.replaced);
      Follower follower(world, state, w, i, work);
      act(follower);
    }
  };
  for_each([](Follower& follower) { follower.follow_route(); });
  publish_rights_of_way(world, state, w);
  for_each([](Follower& follower) { follower.update_target(); });
}

void keep_routes(const World& world, State& state, int w, Workspace& work, int only) {
  if (!world.routed.empty()) work.stop_hulls.clear(world.objects);
  for (const int i : world.routed) {
    if ((only >= 0 && only != i) || !follows_route(world, state, w, i)) continue;
    const Belief belief(world, state, w, i, work, work.replaced);
    Follower(world, state, w, i, work).adjust_command();
  }
}

}  // namespace irsim
