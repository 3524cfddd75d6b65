// One object on its route during one step. `plan_route.cpp` plans, `route.cpp` follows corners, `follow_legs.cpp`
// follows poses through narrow places, `parked.cpp` finds ways round objects that stand for good, `steering.cpp` turns
// paths and poses into commands that keep clear of static objects.
#pragma once

#include "footprints/manoeuvres.hpp"
#include "phases.hpp"
#include "routes/extents.hpp"
#include "routes/route.hpp"
#include "world/spec.hpp"

namespace irsim {

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
        glides_(glides(world, state, row_, object)),
        reach_(sweeping_reach(shapes_, object)),
        blockers_{fixed_.closed ? *fixed_.closed->shapes : shapes_,
                  fixed_.closed ? fixed_.closed->outlines : fixed_.outlines,
                  fixed_.closed ? fixed_.closed->grid : fixed_.grid, world.unobstructed.data(), nullptr} {
    if (!options_.within.empty()) within_.emplace(options_.within);
    collect_avoided();
  }

  /// Plan where that is due, go on along the route, and note the progress.
  void follow_route();
  /// React to objects that are in the way, and set `State::target` to the point that the behavior heads for.
  void update_target();
  /// Change the command of the behavior so that the object stays on its route and hits no static object.
  void adjust_command();

 private:
  static constexpr double kMaxHeadingError = 0.35;  // larger errors are corrected by turning on the spot [rad]

  void adjust(Vec3& u);
  Vec2 position() const;
  Box bounds() const;
  const Region* region() const { return within_ ? &*within_ : nullptr; }
  /// Whether the zones that the object avoids are solid from now on.
  void mind_avoided(bool solid) { blockers_.others = solid && !avoided_.empty() ? &avoided_ : nullptr; }
  /// Make the zones that the object avoids, and what its path leads round, solid.
  void collect_avoided();
  /// Whether another object stands for good: a collision has stopped it, or it rests at its last goal.
  bool is_parked(int other) const;
  /// Write the objects that stand for good within reach of the rest of the path.
  void find_parked(std::vector<int>& found) const;
  /// Plan a way round objects that stand for good on the path: at once under `dash`, which does not avoid them, else
  /// when the object makes no progress. The present path stays if there is no way round.
  void go_round_parked();
  /// Whether the object is in a zone that it avoids, into which it was pushed or in which it starts.
  bool is_in_avoided() const;
  /// Whether one of the bodies of the route can move straight between two points.
  bool sees(std::size_t body, Vec2 from, Vec2 to);
  /// Go on to the next corner where it is reached or the one after it is in sight.
  void advance();
  /// Set the target so far ahead that behaviors do not slow down at corners, in the direction of the next corner.
  void aim(Goal& target);

  bool plan_is_due() const;
  void plan();
  /// Log, once for every goal, that there is no path to it.
  void report_no_path();
  /// Report that there is no path if the object rests for long on a path that was planned for a smaller body, or that
  /// is not known to lead to the heading of its goal.
  void report_if_stuck();
  /// Plan poses for a drive that cannot move sideways and cannot turn everywhere.
  bool find_legs(double reach, int most = kMaxPoses);
  /// Whether the object is a car that must reach a heading at its goal.
  bool parks() const;
  /// Whether it is time to plan poses to that heading: the car is near its goal and has no such plan.
  bool parking_is_due() const;
  /// Plan poses to the heading of the goal. The present path stays if there is no such plan.
  void plan_parking();
  /// A place near where a path may go, for an object that has left its region or is in a zone that it avoids.
  Vec2 way_back(const Space& space, bool left_region) const;
  /// Plan a path on which `wide` fits; `tight` is the body for which corners must stay in sight. Without `search` only
  /// the straight line is tried.
  bool attempt(const Body& wide, const Body& tight, bool search);

  /// Radius of the turning circle that plans of a car use [m].
  double turning_radius(const Car& car) const;
  double max_steering(const Car& car) const;
  /// The command that continues along the legs, which are cleared when the last one is finished.
  void follow_legs(Vec3& u);
  /// Slow down where the command would lead to a collision, or turn aside during a retreat. Returns false if nothing
  /// helps.
  bool slow_down_on_leg(Vec3& u);
  /// Legs of a drive that turns on the spot.
  void follow_legs_in_place(Vec3& u);
  /// Legs of a car, by pure pursuit of those with one direction. Coulter: "Implementation of the Pure Pursuit Path
  /// Tracking Algorithm" (1992).
  void follow_legs_by_pursuit(Vec3& u);
  /// Largest speed, at most `most`, from which a control can stop within `left` [m or rad].
  double stopping_speed(double left, int control, double most) const;
  /// Largest speed forward (`way` > 0) or backward [m/s].
  double top_speed(int way) const;

  /// The law of dash on a route: straight to the next corner, at a speed from which the object can turn there.
  void steer_to_corner(Vec3& u);
  /// Slow down so that the object can stop at its last goal, at the end of its path.
  void slow_down_to_goal(Vec3& u) const;
  /// Let a car back up first when its goal lies within its turning circle.
  void back_off_from_goal();
  /// Note how much of the way is left, and whether the object gets on.
  void track_progress();
  /// Note the poses of the last metres, along which the object can retreat.
  void keep_track();
  /// Turn round what blocks an object that cannot move sideways: it plans again round those in its way, or retreats
  /// along its track for another one that goes first.
  void recover();
  /// Start a retreat that lets another object pass. Returns false if there is no track or no reverse gear.
  bool retreat(int other);
  /// End a retreat.
  void forget_retreat();
  /// Plan poses round all movers where they are. The present route stays if there is no such plan.
  bool plan_among_others();
  /// How far an object can get in two steps and the stop after them [m].
  double range(int object) const;
  /// An object, to be run ahead.
  Ahead ahead_of(int object) const;
  /// Index in `Workspace::stop_hulls` of what an object covers if it brakes now; of its body if it is on no route.
  int stop_of(int object);
  /// Find the widest strip between what this object and another one cover until they stand.
  ///
  /// Args:
  ///   side: The part of the plane up to which this object then reaches, seen across the strip.
  /// Returns: Its width [m].
  double strip_between_stops(int other, Side& side);
  /// Find the lines between this object and its moving neighbors, and write its sides of them to `Workspace::sides`.
  ///
  /// Where one of two cannot stop at once, the line runs between the ways on which both come to rest if they brake now.
  /// So braking is always allowed, and two that stay on their sides never touch.
  void find_sides();
  /// Whether the object stays on its sides in a step with this command and in the stop after it.
  bool stays_on_sides(const Vec3& command);
  /// A command that leads along these lines: a drive that cannot move sideways turns there first. None if it is not
  /// worth it.
  std::optional<Vec3> along_sides(const Vec3& u);
  /// Slow down or turn aside where the command would cross such a line, so that nothing that moves is touched.
  void keep_apart(Vec3& u);
  /// Slow down, veer or back up where the command would end in a collision with a static object.
  void keep_clear(Vec3& u);
  /// The control that brakes; the wheels of a car keep their angle. A step ago this stop was free.
  Vec3 braking() const;
  /// A car that stops because no command is free keeps its wheels as they are if it would touch something static with
  /// the wanted steering.
  void hold_steering(Vec3& u);
  /// Stop.
  void brake(Vec3& u);
  /// Set the gap to walls that the next command must keep: the gap of the route, or a little less than the present gap.
  void measure_gap();
  /// The body at a pose that is tried.
  Footprint body_at(const Pose& pose);
  /// Whether the body touches nothing static between two times of a step [s], at both of which it does not.
  ///
  /// Args:
  ///   pose: At the start of the step.
  ///   twist: Of the step.
  ///   halvings: How often the time may be halved; what is then left is free.
  bool clear_between(const Pose& pose, const Vec3& twist, double from, double to, int halvings);
  /// Whether the body at a pose touches nothing static, keeps the gap to it, and stays on its `Workspace::sides`.
  bool clear_at(const Pose& pose);
  /// Whether a command, followed by braking as hard as the limits allow, leads to no collision.
  bool clear_after(const Vec3& command);

  const World& world_;
  State& state_;
  int w_, object_, row_;
  Workspace& work_;
  const RouteOptions& options_;
  Route& route_;
  const Fixed& fixed_;
  const Shapes& shapes_;
  const bool glides_;   // whether it cannot stop at once
  const double reach_;  // how far it reaches where a turn matters [m]
  Blockers blockers_;
  double gap_ = 0.0;                // gap to static objects that the next command must keep [m]
  std::optional<Region> within_;    // area that the path must not leave
  std::vector<Footprint> avoided_;  // zones that are solid for this object, and parked objects
};

}  // namespace irsim
