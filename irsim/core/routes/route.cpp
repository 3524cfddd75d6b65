#include "routes/route.hpp"

#include "collision/touch.hpp"
#include "geometry/predicates.hpp"
#include "phases.hpp"
#include "planning/plan.hpp"
#include "world/features.hpp"
#include "world/spec.hpp"

namespace irsim {
namespace {

constexpr double kMargin = 0.3;                      // room beside a path that is wished for, as a share of the radius
constexpr double kMostMargin = 0.3;                  // [m]
constexpr double kShares[] = {1.0, 0.3, 0.05, 0.0};  // of the margin, tried in turn
constexpr double kNear = 0.05;                       // a corner this near counts as reached [m]
constexpr double kFacing = 0.35;                     // larger heading errors are turned away in place [rad]
constexpr double kPatience = 1.0;                    // between plans because the path was lost [s]
constexpr int kTries = 10;                           // of a planner that draws samples
constexpr int kBackingSteps = 8;                     // once begun
constexpr double kLegEnd = 0.01;                     // a leg this near its end is done [m], and [rad] of a turn
constexpr double kLegGain = 2.0;                     // of turning back to the line of a leg [1/s], [rad/(m s)]
constexpr double kSteeringShare = 0.9;               // of the largest steering angle that poses are planned with
constexpr int kMostWaits = 30;    // steps something is in the way of a leg before there is a new plan
constexpr int kMostBraking = 40;  // steps of braking looked ahead
constexpr double kStood = 0.1;    // who gets no farther than this [m] ...
constexpr double kStuck = 5.0;    // ... for so long [s] on a way that may be too narrow has no path
constexpr std::uint64_t kDrawsPerPlan = std::uint64_t{1} << 40;

/// Distances of a body from its origin: farthest, and farthest to the side.
struct Extent {
  double reach = 0.0, side = 0.0;
};
Extent extent_of(const Shapes& shapes, int object) {
  Extent extent;
  const Slot& slot = shapes.body[object];
  for (int p = 0; p < shapes.part_count(object); ++p) {
    const Part& part = shapes.parts[slot.part + p];
    for (int v = part.first; v <= part.last; ++v) {
      const Vec2 vertex = shapes.vertices[slot.vertex + v];
      extent.reach = std::max(extent.reach, norm(vertex) + part.radius);
      extent.side = std::max(extent.side, std::fabs(vertex.y) + part.radius);
    }
  }
  return extent;
}

/// Radius of the largest disc about the origin within the convex hull of what bounds a footprint, or within one of its
/// circles: a lower bound of the room it takes up in every heading.
double room_of(const Shapes& shapes, int object) {
  double room = 0.0;
  const Slot& slot = shapes.body[object];
  for (int p = 0; p < shapes.part_count(object); ++p) {
    const Part& part = shapes.parts[slot.part + p];
    const Vec2* vertices = &shapes.vertices[slot.vertex];
    if (part.kind == Kind::circle) {
      room = std::max(room, part.radius - norm(vertices[part.first]));
      continue;
    }
    double within = part.kind == Kind::polygon ? kInfinity : 0.0;
    for (int v = part.first; v < part.last && within > 0.0; ++v) {
      const Vec2 a = vertices[v], b = vertices[v + 1];
      within = std::min(within, part.turn * cross(b - a, a * -1.0) > 0.0 ? norm(nearest_on_segment(a, b, {})) : 0.0);
    }
    room = std::max(room, within);
  }
  return room;
}

bool draws_samples(const Planner& planner) {
  return !std::holds_alternative<AstarOptions>(planner) && !std::holds_alternative<JpsOptions>(planner);
}

/// The cells of a map that plans may be made on.
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

/// One object on its way.
class Follower {
 public:
  Follower(const World& world, State& state, int w, int object, Workspace& work)
      : world_(world),
        state_(state),
        w_(w),
        object_(object),
        row_(w * world.objects + object),
        work_(work),
        options_(*world.specs[object].route),
        route_(state.routes[row_]),
        fixed_(*state.scenes[w].fixed),
        shapes_(*state.scenes[w].shapes),
        blockers_{shapes_, fixed_.outlines, fixed_.grid, world.unobstructed.data()} {}

  void head() {
    const Goal& goal = state_.goal[row_];
    Goal& target = state_.target[row_];
    target = goal;
    if (std::isnan(goal.x)) return;
    if (due()) plan();
    if (route_.path.empty()) {
      target.x = target.y = kNone;
      return;
    }
    if (!route_.legs.empty()) {
      const Vec2 point = route_.legs[route_.leg].pose.position();
      target = {point.x, point.y, kNone};
      return;
    }
    advance();
    if (route_.next + 1 == route_.path.size() && !(options_.lookahead > 0.0)) return;
    aim(target);
  }

  void keep() {
    Vec3& u = state_.command[row_];
    if (std::isnan(state_.goal[row_].x)) return;
    if (route_.path.empty()) {
      u = {};
      return;
    }
    if (!route_.legs.empty()) {
      go_on_legs(u);
      if (!route_.legs.empty()) return;
    }
    if (route_.unsure) look_whether_stuck();
    if (std::holds_alternative<DashOptions>(world_.specs[object_].behavior)) steer(u);
    if (route_.hold) u[2] = 0.0;
    back_off_goal();
    keep_clear(u);
  }

 private:
  Vec2 position() const { return state_.pose[row_].position(); }
  Box bounds() const {
    const auto& b = world_.extent;
    Box box{b[0], b[1], b[2], b[3]};
    box.include(position());
    box.include(state_.goal[row_].position());
    return box;
  }
  bool sees(std::size_t body, Vec2 from, Vec2 to) {
    return Space{blockers_, route_.bodies[body], bounds(), false}.clear(from, to);
  }

  bool due() const {
    const Goal& goal = state_.goal[row_];
    if (!(route_.goal.x == goal.x && route_.goal.y == goal.y) || route_.among != state_.scenes[w_].fixed) return true;
    const double age = static_cast<double>(state_.count[w_] - route_.planned_at) * world_.step_time;
    return options_.replan > 0.0 && age >= options_.replan * (1.0 - 1e-9);
  }

  void plan() {
    const Goal& goal = state_.goal[row_];
    const bool same_way = route_.goal.x == goal.x && route_.goal.y == goal.y && route_.among == state_.scenes[w_].fixed;
    if (!(route_.goal.x == goal.x && route_.goal.y == goal.y)) route_.told = false, route_.stood = {kNone, kNone};
    const bool in_vain = same_way && route_.unsure && norm(route_.tried.position() - position()) < kStood &&
                         std::fabs(wrap(route_.tried.theta - state_.pose[row_].theta)) < kFacing;
    route_.unsure = false;
    route_.goal = goal.position();
    route_.planned_at = state_.count[w_];
    route_.among = state_.scenes[w_].fixed;
    route_.path.clear();
    route_.legs.clear();
    route_.hold = false;
    route_.waits = 0;
    route_.next = 1;
    route_.room = room_of(shapes_, object_);
    const Extent extent = extent_of(shapes_, object_);
    const double margin = std::min(kMargin * extent.reach, kMostMargin);
    // who keeps a heading needs room for the body as it stands; others for all headings, or at least for driving ahead
    const bool sideways = std::holds_alternative<OmniAngularOptions>(world_.drive[object_]);
    const auto as_it_stands = [&] {
      const double theta = state_.pose[row_].theta;
      const Body tight = Body::of(shapes_, object_, theta, 0.0);
      for (const double share : kShares) {
        if (attempt(Body::of(shapes_, object_, theta, share * margin), tight, true)) return true;
      }
      return false;
    };
    if (std::holds_alternative<OmniOptions>(world_.drive[object_])) {
      as_it_stands();
    } else {
      const double side = std::min(extent.side, extent.reach);
      const Body ahead = Body::disc(side), easy = Body::disc(side * (1.0 + 0.5 * kMargin));
      const bool round = side == extent.reach;
      bool found = !round && attempt(easy, ahead, false);
      for (const double share : kShares) {
        if (found || !attempt(Body::disc(extent.reach + share * margin), ahead, true)) continue;
        found = true;
        // enough to turn anywhere; a car keeps its heading nearly
        if (!std::holds_alternative<AckerOptions>(world_.drive[object_])) route_.room = extent.reach;
      }
      if (!found && !round && sideways) found = route_.hold = as_it_stands();
      if (!found && !round && !sideways) {
        found = !in_vain && find_legs(extent.reach);
        if (!found) route_.unsure = true, route_.tried = in_vain ? route_.tried : state_.pose[row_];
      }
      found = found || (!round && (attempt(easy, ahead, true) || attempt(ahead, ahead, true)));
    }
    if (route_.path.empty()) tell();
  }

  /// Once for every goal: there is no path.
  void tell() {
    if (route_.told) return;
    route_.told = true;
    state_.log(world_, w_, EventKind::no_path, object_, -1, position());
  }

  /// On a path for less than the whole body, standing still for long means that it does not fit through.
  void look_whether_stuck() {
    const Vec2 here = position();
    if (!(norm(here - route_.stood) <= kStood)) {
      route_.stood = here, route_.stood_at = state_.count[w_];
      return;
    }
    const double stood = static_cast<double>(state_.count[w_] - route_.stood_at) * world_.step_time;
    const double left = norm(state_.goal[row_].position() - here);
    if (stood >= kStuck && left > world_.goal_threshold[object_]) tell();
  }

  /// Poses for a drive that does not move sideways where there is no room to turn everywhere.
  bool find_legs(double reach) {
    const Drive& drive = world_.drive[object_];
    const auto* car = std::get_if<AckerOptions>(&drive);
    if (car == nullptr && !std::holds_alternative<DiffOptions>(drive)) return false;
    const double radius = car == nullptr ? 0.0 : car->wheelbase / std::tan(kSteeringShare * most_steering(*car));
    const double room = room_of(shapes_, object_);
    const bool backs = world_.vel_min[object_][0] < 0.0;
    const PoseProblem problem{
        blockers_, shapes_, object_, bounds(), state_.pose[row_], route_.goal, world_.goal_threshold[object_],
        backs,     radius,  reach,   room};
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

  double most_steering(const AckerOptions& car) const {
    const double psi = std::min(car.psi_max, 1.4);
    return car.mode == Steering::steer ? std::min(psi, world_.vel_max[object_][1]) : psi;
  }

  /// The command that goes on along the legs; they are cleared when the last one is done.
  void go_on_legs(Vec3& u) {
    if (std::holds_alternative<AckerOptions>(world_.drive[object_])) {
      roll(u);
    } else {
      turn_and_roll(u);
    }
    if (route_.leg >= route_.legs.size()) {  // the rest of the way is straight
      route_.legs.clear();
      route_.path = {position(), route_.goal};
      route_.next = 1;
      return;
    }
    for (const double share : {1.0, 0.5, 0.25, 0.1}) {
      Vec3 v = u;
      v[0] *= share;
      if (!std::holds_alternative<AckerOptions>(world_.drive[object_])) v[1] *= share;
      if (!clear_after(v)) continue;
      u = v;
      route_.waits = 0;
      return;
    }
    u = {};
    if (++route_.waits > kMostWaits) {
      route_.waits = 0;
      plan();
    }
  }

  /// Speed at which the rest of a piece can be ended in time.
  double speed_for(double left, int control, double most) const {
    const double acce = world_.acce[object_][control];
    double speed = std::min(most, left / world_.step_time);
    if (std::isfinite(acce) && acce > 0.0) {
      const double change = acce * world_.step_time;
      speed = std::min(speed, -0.5 * change + std::sqrt(0.25 * change * change + 2.0 * acce * left));
    }
    return std::max(speed, 0.0);
  }

  double top(int way) const { return way > 0 ? world_.vel_max[object_][0] : std::fabs(world_.vel_min[object_][0]); }

  void turn_and_roll(Vec3& u) {
    const Pose& pose = state_.pose[row_];
    std::vector<Leg>& legs = route_.legs;
    for (; route_.leg < legs.size(); ++route_.leg) {
      const Leg& leg = legs[route_.leg];
      u = {};
      if (leg.way == 0) {
        const double error = wrap(leg.pose.theta - pose.theta);
        if (std::fabs(error) < kLegEnd) continue;
        const double rate = speed_for(std::fabs(error), 1, std::fabs(world_.vel_max[object_][1]));
        u[1] = error > 0.0 ? rate : -rate;
        return;
      }
      const Vec2 along = unit(leg.pose.theta), gap = leg.pose.position() - pose.position();
      const double left = leg.way * dot(gap, along);
      if (left < kLegEnd) continue;
      const double most = std::fabs(world_.vel_max[object_][1]);
      u[0] = leg.way * speed_for(left, 0, top(leg.way));
      u[1] = clip(-kLegGain * (wrap(pose.theta - leg.pose.theta) + leg.way * cross(gap, along)), -most, most);
      return;
    }
  }

  /// A car, by pure pursuit along legs of one direction. Coulter: "Implementation of the Pure Pursuit Path Tracking
  /// Algorithm" (1992).
  void roll(Vec3& u) {
    const auto& car = std::get<AckerOptions>(world_.drive[object_]);
    const Pose& pose = state_.pose[row_];
    const std::vector<Leg>& legs = route_.legs;
    u = {};
    while (route_.leg < legs.size()) {
      const int way = legs[route_.leg].way;
      std::size_t last = route_.leg;
      while (last + 1 < legs.size() && legs[last + 1].way == way) ++last;
      const double ahead = std::max(0.15, 0.6 * car.wheelbase);
      while (route_.leg < last && norm(legs[route_.leg].pose.position() - pose.position()) < ahead) ++route_.leg;
      Vec2 gap = legs[route_.leg].pose.position() - pose.position();
      double left = kInfinity;
      if (route_.leg == last) {
        const Vec2 along = unit(legs[last].pose.theta);
        left = way * dot(gap, along);
        if (left < kLegEnd) {
          ++route_.leg;
          continue;
        }
        const double short_by = ahead - norm(gap);
        if (short_by > 0.0) gap = gap + along * (way * short_by);
      }
      const Vec2 point = unrotate(gap, state_.heading(row_));
      const double most = most_steering(car);
      const double psi = clip(std::atan(2.0 * point.y / squared(point) * car.wheelbase), -most, most);
      const double now = state_.extra[static_cast<std::size_t>(row_) * state_.extra_rows];
      u[0] = way * speed_for(left, 0, std::min(top(way), 0.4 * ahead / world_.step_time));
      u[1] = car.mode == Steering::steer ? psi : (psi - now) / world_.step_time;
      return;
    }
  }

  /// Look for a path for a body, wider than that for which sight is asked for; `search`: not only the straight one.
  bool attempt(const Body& wide, const Body& tight, bool search) {
    route_.bodies.assign({wide, tight});
    const Vec2 start = position(), goal = route_.goal;
    const Box box = bounds();
    const Space space{blockers_, route_.bodies[0], box, false}, close{blockers_, route_.bodies[1], box, false};
    if (space.clear(start, goal) || (norm(goal - start) <= world_.goal_threshold[object_])) {
      route_.path = {start, goal};
      return true;
    }
    if (!search) return false;
    const std::optional<Lattice> own = lattice_of_map(world_, shapes_, box);
    const int tries = draws_samples(options_.planner) ? kTries : 1;
    for (int k = 0; k < tries && route_.path.empty(); ++k) {
      const Draws draws(state_.key(w_), Stream::planner, world_.number[object_]);
      const Problem problem{
          space,       start, goal, &close, own ? &*own : nullptr, false, draws, kDrawsPerPlan * route_.plans++,
          work_.search};
      route_.path = find_path(options_.planner, problem).path;
    }
    if (route_.path.empty()) return false;
    shorten(space, route_.path);
    return true;
  }

  /// Go on to the next corner where it is reached or the one after it is in sight.
  void advance() {
    const Vec2 here = position();
    const std::vector<Vec2>& path = route_.path;
    const double stride =
        std::max(kNear, 0.5 * norm({state_.twist[row_][0], state_.twist[row_][1]}) * world_.step_time);
    std::size_t& next = route_.next;
    while (next + 1 < path.size() && (norm(path[next] - here) <= stride || sees(0, here, path[next + 1]))) ++next;
    if (sees(1, here, path[next])) return;
    // pushed aside: back to a corner in sight, else a new path
    for (std::size_t k = next; k-- > 1;) {
      if (sees(1, here, path[k])) {
        next = k;
        return;
      }
    }
    const double age = static_cast<double>(state_.count[w_] - route_.planned_at) * world_.step_time;
    if (age < kPatience) return;
    const std::vector<Vec2> old = path;
    plan();
    if (route_.path.empty()) route_.path = old, route_.next = std::min(next, old.size() - 1);
  }

  /// Behaviors slow down near what they head for: a corner to pass is put farther away, in the same direction.
  void aim(Goal& target) {
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
    const double distance = norm(way), least = 2.0 * world_.goal_threshold[object_] + 0.2;
    if (distance > 0.0 && distance < least) point = here + way * (least / distance);
    target = {point.x, point.y, kNone};
  }

  /// dash on a route: on the straight line to the corner, at a speed that lets the object turn there.
  void steer(Vec3& u) {
    const Goal& target = state_.target[row_];
    const bool last = route_.next + 1 == route_.path.size();
    const Pose& pose = state_.pose[row_];
    const Vec2 way = target.position() - pose.position();
    if (last && norm(way) < world_.goal_threshold[object_]) return;
    const double error = wrap(std::atan2(way.y, way.x) - pose.theta);
    const Vec3 &top = world_.vel_max[object_], &acce = world_.acce[object_];
    const double left = norm(route_.path[route_.next] - pose.position());
    double most = kInfinity;
    if (!last) {
      most = left / world_.step_time;
      if (std::isfinite(acce[0]) && acce[0] > 0.0) most = std::min(most, std::sqrt(2.0 * acce[0] * left));
      most = std::max(most, 0.05);
    }
    with(world_.drive[object_], [&](const auto& drive) {
      using Drive = std::decay_t<decltype(drive)>;
      if constexpr (std::is_same_v<Drive, DiffOptions>) {
        double rate = std::min(std::fabs(top[1]), std::fabs(error) / world_.step_time);
        if (std::isfinite(acce[1]) && acce[1] > 0.0) {  // such that the turn can be ended in time
          const double change = acce[1] * world_.step_time;
          rate = std::min(rate, -0.5 * change + std::sqrt(0.25 * change * change + 2.0 * acce[1] * std::fabs(error)));
        }
        u[1] = error > 0.0 ? rate : -rate;
        u[0] = std::fabs(error) > kFacing ? 0.0 : std::min(u[0], most);
      } else if constexpr (std::is_same_v<Drive, OmniOptions> || std::is_same_v<Drive, OmniAngularOptions>) {
        const double c = std::cos(error), s = std::sin(error);
        const double speed = std::min(
            {std::fabs(top[0]) / std::max(std::fabs(c), 1e-9), std::fabs(top[1]) / std::max(std::fabs(s), 1e-9), most});
        u[0] = speed * c, u[1] = speed * s;
      } else if constexpr (std::is_same_v<Drive, AckerOptions>) {
        if (drive.mode != Steering::steer) return;
        const double most_psi = std::min({top[1], drive.psi_max, 1.4});
        u[1] = clip(error, -most_psi, most_psi);
        u[0] = std::min(u[0], std::max(most, 0.3 * top[0]));
      }
    });
  }

  /// A goal within the turning circle of a car is reached by going back first.
  void back_off_goal() {
    const auto* car = std::get_if<AckerOptions>(&world_.drive[object_]);
    if (car == nullptr || route_.next + 1 < route_.path.size() || route_.backing > 0) return;
    const Vec2 way = state_.goal[row_].position() - position();
    const double threshold = world_.goal_threshold[object_];
    if (norm(way) < threshold) return;
    const double radius = car->wheelbase / std::tan(most_steering(*car));
    const Vec2 point = unrotate(way, state_.heading(row_)), centre{0.0, point.y >= 0.0 ? radius : -radius};
    if (norm(point - centre) < radius - 0.5 * threshold) route_.backing = kBackingSteps;
  }

  /// Slower, or backwards, where the command would end at something that stands still.
  void keep_clear(Vec3& u) {
    if (std::holds_alternative<std::monostate>(world_.drive[object_]) || !clear_at(state_.pose[row_])) return;
    const bool car = std::holds_alternative<AckerOptions>(world_.drive[object_]);
    const int moving = std::holds_alternative<OmniOptions>(world_.drive[object_]) ||
                               std::holds_alternative<OmniAngularOptions>(world_.drive[object_])
                           ? 2
                           : 1;
    const auto scaled = [&](double share, double turn) {
      Vec3 v = u;
      for (int c = 0; c < 3; ++c) v[c] *= c < moving ? share : turn;
      return v;
    };
    const auto back = [&] {
      Vec3 v;
      v[0] = 0.4 * world_.vel_min[object_][0];
      if (car) v[1] = -u[1];
      return v;
    };
    if (route_.backing > 0) {
      --route_.backing;
      if (clear_after(back())) {
        u = back();
        return;
      }
      route_.backing = 0;
    }
    for (const double share : {1.0, 0.5, 0.25, 0.1}) {
      if (!clear_after(scaled(share, 1.0))) continue;
      u = scaled(share, 1.0);
      return;
    }
    if (moving == 2) {  // past it, then where there is no room to turn
      for (const double angle : {0.4, 0.8, 1.2}) {
        for (const double share : {1.0, 0.5, 0.25}) {
          for (const double sign : {1.0, -1.0}) {
            Vec3 v = scaled(share, 1.0);
            const Vec2 veered = rotate({v[0], v[1]}, unit(sign * angle));
            v[0] = veered.x, v[1] = veered.y;
            if (!clear_after(v)) continue;
            u = v;
            return;
          }
        }
      }
      for (const double share : {1.0, 0.5, 0.25, 0.1}) {
        if (!clear_after(scaled(share, 0.0))) continue;
        u = scaled(share, 0.0);
        return;
      }
    }
    const bool stands = norm({state_.control[row_][0], moving == 2 ? state_.control[row_][1] : 0.0}) < 0.02;
    if (!car && clear_after(scaled(0.0, 1.0))) {
      u = scaled(0.0, 1.0);
      return;
    }
    if (moving == 1 && stands && world_.vel_min[object_][0] < 0.0 && clear_after(back())) {
      route_.backing = kBackingSteps;
      u = back();
      return;
    }
    u = scaled(0.0, car ? 1.0 : 0.0);
  }

  bool clear_at(const Pose& pose) {
    work_.ghost.resize(shapes_.size[0]);
    work_.ghost.place(shapes_, object_, pose, unit(pose.theta));
    const Footprint body = work_.ghost.footprint(shapes_, object_);
    if (blockers_.meet(body)) return false;
    if (route_.legs.empty()) return true;
    // legs are driven as they are: who is in the way is waited for
    return std::none_of(world_.moving.begin(), world_.moving.end(), [&](int i) {
      return i != object_ && !world_.unobstructed[i] && touch(body, state_.scenes[w_].moving.footprint(shapes_, i));
    });
  }

  /// Whether a command, then braking as hard as the limits allow, meets nothing.
  bool clear_after(const Vec3& command) {
    Pose pose = state_.pose[row_];
    Vec3 control = state_.control[row_], wanted = command, twist;
    const double* extra = &state_.extra[static_cast<std::size_t>(row_) * state_.extra_rows];
    work_.extra.assign(extra, extra + state_.extra_rows);
    for (int k = 0; k < kMostBraking; ++k) {
      bool moves = false;
      for (int c = 0; c < 3; ++c) {
        const double change = world_.acce[object_][c] * world_.step_time;
        control[c] = clip(wanted[c], std::max(world_.vel_min[object_][c], control[c] - change),
                          std::min(world_.vel_max[object_][c], control[c] + change));
        moves = moves || control[c] != 0.0;
      }
      if (k > 0 && !moves) return true;
      with(world_.drive[object_], [&](const auto& drive) {
        control = constrain(drive, control);
        run(drive, Motion{pose, work_.extra.data(), twist, unit(pose.theta), control, world_.step_time});
      });
      if (!clear_at(pose)) return false;
      wanted = {};
      if (std::holds_alternative<AckerOptions>(world_.drive[object_])) {
        wanted[1] = command[1];
        if (k > 0 && std::fabs(control[0]) < 1e-9) return true;
      }
    }
    return true;
  }

  const World& world_;
  State& state_;
  int w_, object_, row_;
  Workspace& work_;
  const RouteOptions& options_;
  Route& route_;
  const Fixed& fixed_;
  const Shapes& shapes_;
  Blockers blockers_;
};

bool drives(const World& world, const State& state, int w, int object) {
  const int row = w * world.objects + object;
  return !world.is_static[object] && !state.stopped[row] && !state.given[row];
}

}  // namespace

void find_routes(const World& world, State& state, int w, Workspace& work, int only) {
  if (world.routed.empty()) return;
  const int first = w * world.objects;
  for (int i = 0; i < world.objects; ++i) state.target[first + i] = state.goal[first + i];
  for (const int i : world.routed) {
    if ((only < 0 || only == i) && drives(world, state, w, i)) Follower(world, state, w, i, work).head();
  }
}

void keep_routes(const World& world, State& state, int w, Workspace& work, int only) {
  for (const int i : world.routed) {
    if ((only < 0 || only == i) && drives(world, state, w, i)) Follower(world, state, w, i, work).keep();
  }
}

}  // namespace irsim
