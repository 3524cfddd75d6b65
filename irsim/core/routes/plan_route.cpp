#include "routes/follower.hpp"

#include "planning/plan.hpp"
#include "routes/extents.hpp"

namespace irsim {
namespace {

constexpr double kMarginShare = 0.3;                       // wanted margin beside a path, as a share of the radius
constexpr double kMaxMargin = 0.3;                         // upper limit of that margin [m]
constexpr double kMarginShares[] = {1.0, 0.3, 0.05, 0.0};  // shares of the margin, tried in this order
constexpr double kLocalShare = 0.5;           // share of that margin that is kept when others push the object aside
constexpr double kLegMargin = 0.01;           // the same of cars and on legs, whose plans have margins of their own [m]
constexpr int kMaxTries = 10;                 // plans attempted with a planner that draws samples
constexpr double kSteeringShare = 0.9;        // share of the largest steering angle with which poses are planned
constexpr double kRestingDistance = 0.1;      // an object that moves less than this counts as resting [m]
constexpr double kStuckTime = 5.0;            // resting this long on a path that may be too narrow counts as stuck [s]
constexpr double kParkingRadii = 6.0;         // a car plans to the heading of its goal from this many turning radii
constexpr double kTimeBetweenParkings = 1.0;  // after a plan to the heading, before another one [s]
constexpr double kMaxCommonArea = 2500.0;     // a larger world with a map is planned on the cells of the map [m^2]
constexpr int kEntries = 40;                  // places along x and along y at which an object may come back to its way
constexpr std::uint64_t kDrawsPerPlan = std::uint64_t{1} << 40;  // blocks of draws reserved for each plan

bool draws_samples(const Planner& planner) {
  return !std::holds_alternative<AstarOptions>(planner) && !std::holds_alternative<JpsOptions>(planner);
}

/// The cells of a map that covers `bounds`, on which grid planners then search; none without such a map.
std::optional<Lattice> lattice_of_map(const World& world, const Shapes& shapes, const Box& bounds) {
  for (const int i : world.fixed_objects) {
    if (!shapes.is_map(i) || world.unobstructed[i]) continue;
    const OccupancyGrid& grid = *shapes.parts[shapes.body[i].part].cells;
    const Lattice lattice{grid.columns(), grid.rows(), grid.origin(), grid.cell()};
    const Vec2 high = grid.corner(grid.columns(), grid.rows());
    const double slack = 1e-6;
    if (grid.origin().x <= bounds.x0 + slack && grid.origin().y <= bounds.y0 + slack && high.x >= bounds.x1 - slack &&
        high.y >= bounds.y1 - slack) {
      return lattice;
    }
  }
  return std::nullopt;
}

/// The nearest of many places in a box, free in a space, to which the body can move straight through another space from
/// a point that is not free; without one, the point itself.
Vec2 way_in(const Space& space, const Space& through, const Box& box, Vec2 from) {
  Vec2 best = from;
  double nearest = kInfinity;
  for (int i = 0; i < kEntries; ++i) {
    for (int j = 0; j < kEntries; ++j) {
      const Vec2 p{box.x0 + (box.x1 - box.x0) * (i + 0.5) / kEntries,
                   box.y0 + (box.y1 - box.y0) * (j + 0.5) / kEntries};
      const double away = norm(p - from);
      if (away < nearest && space.free(p) && through.clear(from, p)) best = p, nearest = away;
    }
  }
  return best;
}

}  // namespace

Box Follower::bounds() const {
  const auto& b = variant_of(world_, state_, w_).extent;
  Box box{b[0], b[1], b[2], b[3]};
  box.include(position());
  box.include(state_.goal[row_].position());
  return box;
}

bool Follower::plan_is_due() const {
  const Goal& goal = state_.goal[row_];
  if (!(route_.goal.x == goal.x && route_.goal.y == goal.y) || route_.planned_among != state_.scenes[w_].fixed)
    return true;
  const double age = static_cast<double>(state_.count[w_] - route_.planned_at) * world_.step_time;
  return options_.replan > 0.0 && age >= options_.replan * (1.0 - 1e-9);
}

void Follower::plan() {
  const Goal& goal = state_.goal[row_];
  const bool same_way =
      route_.goal.x == goal.x && route_.goal.y == goal.y && route_.planned_among == state_.scenes[w_].fixed;
  if (!(route_.goal.x == goal.x && route_.goal.y == goal.y)) {
    route_.reported = route_.parked_reported = false, route_.resting_at = {kNone, kNone};
    route_.parked.clear(), route_.parked_seen.clear();
    collect_avoided();
  }
  const bool failed_here = same_way && route_.uncertain &&
                           norm(route_.failed_pose.position() - position()) < kRestingDistance &&
                           std::fabs(wrap(route_.failed_pose.theta - state_.pose[row_].theta)) < kMaxHeadingError;
  route_.uncertain = false;
  route_.goal = goal.position();
  route_.planned_at = state_.count[w_];
  route_.planned_among = state_.scenes[w_].fixed;
  route_.path.clear();
  forget_retreat();
  route_.legs.clear();
  route_.keeps_heading = false;
  route_.blocked_steps = 0;
  route_.next = 1;
  route_.wall_radius = inner_radius(shapes_, object_);
  route_.wall_margin = 0.0;
  const Extent extent = extent_of(shapes_, object_);
  const double margin = std::min(kMarginShare * extent.reach, kMaxMargin);
  // A drive that keeps its heading needs free space for the body at that heading only; other drives need it at all
  // headings, or at least for driving straight ahead.
  const bool sideways = std::holds_alternative<OmniAngularOptions>(world_.drive[object_]);
  const auto at_present_heading = [&] {
    const double theta = state_.pose[row_].theta;
    const Body tight = Body::of(shapes_, object_, theta, 0.0);
    for (const double share : kMarginShares) {
      if (!attempt(Body::of(shapes_, object_, theta, share * margin), tight, true)) continue;
      route_.wall_margin = kLocalShare * share * margin;
      route_.wall_radius += route_.wall_margin;
      return true;
    }
    return false;
  };
  if (std::holds_alternative<OmniOptions>(world_.drive[object_])) {
    at_present_heading();
  } else {
    const double side = std::min(extent.side, extent.reach);
    const Body ahead = Body::disc(side), easy = Body::disc(side * (1.0 + 0.5 * kMarginShare));
    const bool round = side == extent.reach;
    bool found = !round && attempt(easy, ahead, false);
    for (const double share : kMarginShares) {
      if (found || !attempt(Body::disc(extent.reach + share * margin), ahead, true)) continue;
      found = true;
      // The body can turn anywhere along this path. A car hardly turns on the spot, so it may pass closer to walls.
      if (steers(world_.drive[object_])) continue;
      route_.wall_margin = kLocalShare * share * margin;
      // Other bodies mostly reach less far than that, which is margin enough.
      route_.wall_radius = extent.reach + (round ? route_.wall_margin : 0.0);
    }
    if (!found && !round && sideways) found = route_.keeps_heading = at_present_heading();
    if (!found && !round && !sideways) {
      found = !failed_here && find_legs(extent.reach);
      if (!found) route_.uncertain = true, route_.failed_pose = failed_here ? route_.failed_pose : state_.pose[row_];
    }
    found = found || (!round && (attempt(easy, ahead, true) || attempt(ahead, ahead, true)));
  }
  if (steers(world_.drive[object_]) || !route_.legs.empty()) route_.wall_margin = kLegMargin;
  if (!route_.path.empty()) return;
  if (route_.parked.empty()) return report_no_path();
  route_.parked.clear();  // there is no way round them, so the path leads past them
  collect_avoided();
  plan();
}

void Follower::report_no_path() {
  if (route_.reported) return;
  route_.reported = true;
  state_.log(world_, w_, EventKind::no_path, object_, -1, position());
}

void Follower::report_if_stuck() {
  const Vec2 here = position();
  if (!(norm(here - route_.resting_at) <= kRestingDistance)) {
    route_.resting_at = here, route_.resting_since = state_.count[w_];
    return;
  }
  const double stood = static_cast<double>(state_.count[w_] - route_.resting_since) * world_.step_time;
  const double left = norm(state_.goal[row_].position() - here);
  if (stood >= kStuckTime && left > world_.goal_threshold[object_]) report_no_path();
}

bool Follower::find_legs(double reach, int most) {
  const Drive& drive = world_.drive[object_];
  const std::optional<Car> car = car_of(drive);
  if (!car && !turns_in_place(drive)) return false;
  const double radius = !car ? 0.0 : turning_radius(*car);
  const double room = inner_radius(shapes_, object_);
  const bool backs = state_.vel_min[row_][0] < 0.0;
  const PoseProblem problem{blockers_,
                            shapes_,
                            object_,
                            bounds(),
                            state_.pose[row_],
                            route_.goal,
                            parks() ? state_.goal[row_].theta : kNone,
                            world_.goal_threshold[object_],
                            backs,
                            radius,
                            reach,
                            room,
                            region(),
                            most};
  route_.legs = search_poses(problem);
  route_.leg = 1;
  if (route_.legs.size() < 2) {
    route_.legs.clear();
    return false;
  }
  route_.bodies.assign(2, Body::disc(room));
  for (const Leg& leg : route_.legs) route_.path.push_back(leg.pose.position());
  route_.path.push_back(route_.goal);
  return true;
}

double Follower::turning_radius(const Car& car) const {
  return car.wheelbase / std::tan(kSteeringShare * max_steering(car));
}

bool Follower::parks() const {
  return world_.state_arrival[object_] && !std::isnan(state_.goal[row_].theta) && steers(world_.drive[object_]);
}

bool Follower::parking_is_due() const {
  if (!parks() || !route_.legs.empty() || route_.retreats || route_.path.empty() || state_.arrived[row_]) return false;
  const double near = kParkingRadii * turning_radius(*car_of(world_.drive[object_]));
  if (norm(route_.goal - position()) > near) return false;
  const double age = static_cast<double>(state_.count[w_] - route_.parking_at) * world_.step_time;
  return route_.parking_at < 0 || age >= kTimeBetweenParkings;
}

void Follower::plan_parking() {
  route_.parking_at = state_.count[w_];
  std::vector<Vec2> path;
  path.swap(route_.path);
  if (find_legs(extent_of(shapes_, object_).reach)) {
    route_.wall_margin = kLegMargin;
    route_.next = 1;
  } else {
    route_.path.swap(path);
  }
}

Vec2 Follower::way_back(const Space& space, bool left_region) const {
  Box box;
  if (left_region) {
    box = within_->box();
  } else {
    for (const Footprint& zone : avoided_) {
      if (state_.scenes[w_].moving.footprint(shapes_, object_).box.meets(zone.box)) box.include(zone.box);
    }
    const double beyond = 2.0 * space.body.reach();
    box = {box.x0 - beyond, box.y0 - beyond, box.x1 + beyond, box.y1 + beyond};
  }
  Blockers solid = blockers_;
  solid.others = nullptr;
  return way_in(space, Space{solid, space.body, space.bounds, false, space.region}, box, position());
}

bool Follower::attempt(const Body& wide, const Body& tight, bool search) {
  route_.bodies.assign({wide, tight});
  const Vec2 start = position(), goal = route_.goal;
  const Box box = bounds();
  const Space space{blockers_, route_.bodies[0], box, false, region()};
  const Space close{blockers_, route_.bodies[1], box, false, region()};
  if (space.clear(start, goal) || (norm(goal - start) <= world_.goal_threshold[object_])) {
    route_.path = {start, goal};
    return true;
  }
  if (!search) return false;
  const bool left = within_ && !within_->holds(start), outside = left || is_in_avoided();
  const Vec2 from = outside ? way_back(space, left) : start;
  const bool samples = draws_samples(options_.planner);
  // A map is planned on as other walls are, on the grid that has nothing to do with its cells, if that is not too
  // large. Where nothing is found on it, the cells of the map may show a way.
  const std::optional<Lattice> own = samples ? std::nullopt : lattice_of_map(world_, shapes_, box);
  const bool vast = (box.x1 - box.x0) * (box.y1 - box.y0) > kMaxCommonArea;
  const int tries = samples ? kMaxTries : own && !vast ? 2 : 1;
  for (int k = 0; k < tries && route_.path.empty(); ++k) {
    const bool cells = own && (vast || k > 0);
    const Draws draws(state_.key(w_), Stream::planner, world_.number[object_]);
    const Problem problem{
        space, from, goal, &close, cells ? &*own : nullptr, false, draws, kDrawsPerPlan * route_.plans++, work_.search};
    route_.path = find_path(options_.planner, problem).path;
  }
  if (route_.path.empty()) return false;
  if (outside) route_.path.insert(route_.path.begin(), start);
  shorten(space, route_.path);
  return true;
}
}  // namespace irsim
