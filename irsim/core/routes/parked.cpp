// Ways round objects that stand for good on a path.
#include <algorithm>

#include "geometry/predicates.hpp"
#include "routes/extents.hpp"
#include "routes/follower.hpp"
#include "world/features.hpp"

namespace irsim {
namespace {

constexpr double kRestingSpeed = 1e-3;   // a slower object rests [m/s]
constexpr double kParkedPatience = 1.0;  // time between looks at what stands on the path [s]
constexpr double kStuckBehind = 5.0;     // after this time without progress it is logged what is in the way [s]

}  // namespace

bool Follower::is_parked(int other) const {
  const int row = w_ * world_.objects + other;
  if (other == object_ || world_.is_static[other] || world_.unobstructed[other] || state_.absent(row)) return false;
  if (state_.stopped[row]) return true;
  return state_.arrived[row] && !world_.loop[other] && !world_.wander[other] &&
         norm({state_.twist[row][0], state_.twist[row][1]}) < kRestingSpeed;
}

void Follower::collect_avoided() {
  avoided_.clear();
  for (const int zone : options_.avoid) avoided_.push_back(world_.zones.footprint(zone));
  for (const int other : route_.parked) {
    if (is_parked(other)) avoided_.push_back(state_.scenes[w_].moving.footprint(shapes_, other));
  }
  mind_avoided(true);
}

void Follower::find_parked(std::vector<int>& found) const {
  found.clear();
  const double reach = extent_of(shapes_, object_).reach;
  for (const int other : world_.moving) {
    if (!is_parked(other)) continue;
    const Footprint body = state_.scenes[w_].moving.footprint(shapes_, other);
    Vec2 from = position();
    for (std::size_t k = route_.next; k < route_.path.size(); ++k) {
      const Vec2 nearest = nearest_on_segment(from, route_.path[k], body.centre);
      if (norm(nearest - body.centre) < body.radius + reach) {
        found.push_back(other);
        break;
      }
      from = route_.path[k];
    }
  }
}

void Follower::go_round_parked() {
  if (!route_.legs.empty() || route_.retreats || state_.arrived[row_]) return;
  const auto steps = [&](double time) {
    return std::max<std::int64_t>(1, static_cast<std::int64_t>(std::llround(time / world_.step_time)));
  };
  const bool dashes = std::holds_alternative<DashOptions>(world_.specs[object_].behavior);
  const std::int64_t held = route_.right_of_way.held, waited = dashes ? state_.count[w_] : held;
  if (waited <= 0 || waited % steps(kParkedPatience) != 0) return;
  std::vector<int> found;
  find_parked(found);
  if (found.empty()) return;
  std::vector<int> all = route_.parked;
  all.insert(all.end(), found.begin(), found.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  if (all != route_.parked_seen) {
    const Route before = route_;
    route_.parked = all;
    collect_avoided();
    plan();
    if (!route_.parked.empty() && !route_.uncertain) {
      route_.parked_seen = std::move(all);
      return;
    }
    route_ = before;
    route_.parked_seen = std::move(all);
    collect_avoided();
  }
  if (held < steps(kStuckBehind) || route_.parked_reported) return;
  route_.parked_reported = true;
  const Vec2 here = position();
  const int nearest = *std::min_element(found.begin(), found.end(), [&](int a, int b) {
    const auto away = [&](int i) { return norm(state_.pose[w_ * world_.objects + i].position() - here); };
    return away(a) < away(b);
  });
  state_.log(world_, w_, EventKind::no_path, object_, nearest, here);
}

}  // namespace irsim
