// The data that changes during an episode. Row w * N + i holds object i of world w.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "footing.hpp"
#include "footprints/detour.hpp"
#include "orca/opinions.hpp"
#include "parallel.hpp"
#include "random.hpp"
#include "routes/route.hpp"
#include "runs/log.hpp"
#include "sensing/timetable.hpp"
#include "world/actuation.hpp"
#include "world/array.hpp"
#include "world/scene.hpp"
#include "world/workspace.hpp"
#include "world/world.hpp"

namespace irsim {

/// The goal of an object, and whether contacts kept it in place, at the ends of steps from `step` on.
struct Standing {
  std::int64_t step;
  Goal goal;
  std::uint8_t stopped;
};

/// Goals of one object. The queue starts at `head`; `loop` and resets restore `initial`.
struct GoalQueue {
  std::vector<Goal> goals, initial;
  std::size_t head = 0;

  bool empty() const { return head >= goals.size(); }
  std::size_t left() const { return goals.size() - head; }
  void set(const std::vector<Goal>& list) { goals = list, head = 0; }
};

struct State {
  /// With `drawn`, scene 0 of every world is drawn and ready to step.
  State(const World& world, const std::uint64_t* seeds, bool history, bool drawn = true);
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  int worlds, objects, rows, extra_rows;
  bool keep_history;

  // (R,) for each row; `extra` is (R * E,)
  Array<Pose> pose;
  Array<double> extra;
  Array<Vec3> control, twist, command;
  Array<Vec2> commanded;                 // velocity that the caller last asked a row to follow, world frame [m/s]
  Array<Vec3> drive;                     // controls of the drives before contacts change them, command frame
  Array<Actuated> actuated;              // (R,), empty if no object has actuators
  Array<Underfoot> underfoot;            // (R,), empty if no wheels slip
  Array<double> contact_time, air_time;  // time for which an object has touched something, or nothing [s]
  Array<std::uint8_t> given, arrived, collided, stopped;
  Array<std::uint8_t> believes_arrived;  // of rows that go by an estimate: whether they rest at what they take for it
  Array<std::uint8_t> touching;          // bit 0: in contact in the last step, bit 1: in the one before
  Array<double> radius;
  Array<Vec3> vel_min, vel_max;    // limits of the controls in this scene
  Array<Vec3> acce;                // limits of their changes [per s]
  Array<double> pace;              // factor on the speeds of the object in this scene
  Array<std::int64_t> start_step;  // steps that the object stands still at its start
  Array<std::int64_t>
      appeared;  // step in which the object came into the world; -1 before, -2 minus that step afterwards
  // what varies between scenes, see world/variation.hpp
  Array<std::uint8_t> takes_part;  // 0: the object is absent in this scene
  Array<double> size_scale, speed_scale, acceleration_scale, noise_scale, delay_scale, lag_scale;
  Array<double> sensor_rate_scale, sensor_latency_scale, slip_scale, grip_scale;
  Array<std::int32_t> latency;        // steps after which the caller is asked to execute an action
  Array<std::int32_t> infeasible;     // steps of this episode in which no velocity avoided every collision
  Array<std::int32_t> between_steps;  // contacts of this episode between two steps, with nothing touched at either
  Array<Goal> goal;                   // head of the queue; x is NaN without a goal
  // (W * beams_per_world,)
  Array<double> ranges, beam_angles;
  Array<std::int32_t> hits;
  Array<std::uint8_t> valid;     // 1 where the beam hit something within the limits of its range
  Array<double> velocities;      // (W * velocities_per_world,) measured velocities [m/s]
  Array<double> readings;        // (W * readings_per_world,) numbers that sensors without beams report
  Array<double> stamp;           // (W * sensors,) time at which what a sensor shows was measured [s]; NaN before that
  Array<std::uint8_t> explored;  // (W * cells of the fog,) 1 where a robot has seen the cell
  // (W,) for each world
  Array<std::int64_t> count;
  Array<std::uint32_t> scene_index, noise;
  Array<std::int32_t> level;    // of the scenes drawn from now on
  Array<std::int32_t> variant;  // index among `World::variants` in this scene; -1 without any
  Array<std::uint64_t> seed;
  Array<std::int32_t> failed_placement;

  Pending pending;                        // measurements of sensors whose data have not arrived yet
  std::vector<Vec3> queue;                // commands that wait for their dead time, see `Actuators::first`
  std::vector<Vec2> direction;            // (R,) cosine and sine of `direction_of`
  std::vector<double> direction_of;       // (R,) heading for which `direction` was computed [rad]
  std::vector<GoalQueue> goals;           // (R,)
  std::vector<Route> routes;              // (R,), empty if no object has a route
  std::vector<Goal> target;               // (R,), empty likewise: points that behaviors head for
  std::vector<Opinions> opinions;         // (R,), empty if no object runs `avocado`
  std::vector<Detour> detours;            // (R,), empty if no object runs `footprint_orca`
  std::vector<std::int64_t> tied;         // (R,), empty if no object runs `rvo`: step of the last tie; -1 without one
  std::vector<std::uint32_t> goal_draws;  // (R,) wander goals drawn in this episode
  std::vector<double> memory;             // (W * memory_per_world,) what sensors remember from step to step
  std::vector<Pose> before;               // (R,) poses at the beginning of the step
  std::vector<std::uint8_t> overshot;     // (R,) whether an overshoot of the present goal was reported
  std::vector<Pose> initial_pose;         // (R,)
  std::vector<double> initial_extra;
  std::vector<Vec3> initial_control;
  std::vector<std::vector<double>> history;      // (R,) recorded states, K * (3 + E) numbers each
  std::vector<std::vector<Standing>> standings;  // (R,) goals and stops of moving objects, one entry per change
  std::vector<Scene> scenes;                     // (W,)
  std::vector<std::uint8_t> fresh;               // (W,) 1 if the next reset draws scene 0 with noise 0
  std::vector<std::int64_t> event_count;         // (W,) number of events since the state was made
  std::vector<Workspace> workspaces;             // one per thread
  Crew crew;                                     // threads that step its worlds
  std::shared_ptr<Log> record;                   // record of world 0; null unless one is attached

  /// Key of the random draws of the present episode of world w.
  Key key(int w) const { return make_key(seed[w], scene_index[w], noise[w]); }
  /// Whether a row is not in the world, or not yet. Its x and y are NaN, so that nothing meets, sees or avoids it.
  bool absent(int row) const { return appeared[row] < 0; }
  /// Whether a row stands still because its start is delayed, or is absent.
  bool waits(int row) const { return absent(row) || (start_step[row] > 0 && count[row / objects] < start_step[row]); }
  /// Point that the behavior of a row heads for: its goal, or a point of its route.
  const Goal& destination(int row) const { return target.empty() ? goal[row] : target[row]; }
  /// The route that a row follows; null without one. Routes avoid static objects; behaviors only keep
  /// `Route::wall_radius` off them.
  const Route* route_of(int row) const { return routes.empty() || routes[row].path.empty() ? nullptr : &routes[row]; }
  /// The effect of the ground on the two wheels of a row; null if no zone has ground of its own.
  const Footing* footing(const World& world, int row) const {
    return world.zones.grounds.empty() ? nullptr : underfoot[row].wheel.data();
  }
  /// Cosine and sine of the heading of a row.
  Vec2 heading(int row) const { return direction_of[row] == pose[row].theta ? direction[row] : unit(pose[row].theta); }
  Footprint footprint(const World& world, int w, int object) const {
    const Scene& scene = scenes[w];
    return (world.is_static[object] ? scene.fixed->outlines : scene.moving).footprint(*scene.shapes, object);
  }
  /// Centre and radius of the bounding circle, world frame.
  std::pair<Vec2, double> bounds(const World& world, int w, int object) const {
    const Scene& scene = scenes[w];
    const Outlines& outlines = world.is_static[object] ? scene.fixed->outlines : scene.moving;
    return {outlines.centres[scene.shapes->placed[object].object], scene.shapes->radius[object]};
  }
  void log(const World& world, int w, EventKind kind, int object, int partner, Vec2 where) {
    log_numbers(w, kind, world.number[object], partner < 0 ? -1 : world.number[partner], where);
  }
  /// Like `log`, with the numbers of the object and its partner, or the index of a zone.
  void log_numbers(int w, EventKind kind, int number, int partner, Vec2 where) {
    scenes[w].events.push_back({kind, count[w], number, partner, where.x, where.y});
    ++event_count[w];
  }
  void sync_goal(int row) {
    const GoalQueue& q = goals[row];
    goal[row] = q.empty() ? Goal{kNone, kNone, kNone} : q.goals[q.head];
    overshot[row] = 0, believes_arrived[row] = 0;
  }
};

/// The range that a beam measured [m]; infinite without a valid hit.
inline float returned_range(const State& state, std::size_t beam) {
  return state.valid[beam] ? static_cast<float>(state.ranges[beam]) : std::numeric_limits<float>::infinity();
}

/// Let the sensors of world w whose data arrive late or now and then show nothing, as before their first data.
void show_nothing(const World& world, State& state, int w);
/// Draw shapes, placements and goals of world w for its present seed and scene counter, then `restart` it.
void draw_scene(const World& world, State& state, int w, Workspace& work);
/// Draw poses and goals of the random placements of world w. `failed_placement` becomes the first object that did not
/// fit.
void place_randomly(const World& world, State& state, int w);
/// Draw starts, speeds and delays of world w within the spreads of `world.perturbations`. `failed_placement` becomes
/// the first object for which there is no room.
void perturb(const World& world, State& state, int w);
/// Set the limits of a row from the limits of its object and its pace.
void set_limits(const World& world, State& state, int row);
/// Return one object to its initial values; collisions, arrival and sensors are not evaluated.
void restart_row(const World& world, State& state, int row);
/// Return world w to its initial values, then evaluate collisions, arrival and sensors.
void restart(const World& world, State& state, int w, Workspace& work);
/// Reset the worlds where mask is set, on several threads; see `State.reset` in _core.pyi.
void reset(const World& world, State& state, const std::uint8_t* mask, bool next_scene, int threads);
void reseed(State& state, const std::uint64_t* seeds, const std::uint8_t* mask);
/// Update geometry, collisions and sensors after the caller has written poses.
void refresh(const World& world, State& state);

/// Build the geometry of the static objects at their poses unless it is up to date.
void place_fixed(const World& world, State& state, int w);
/// The objects of world w as rigid bodies, which are made when they are first needed.
const Bodies& bodies_of(const World& world, State& state, int w);

/// Call after a pose was written: the geometry of a static object is updated at once, others follow in the next step.
void pose_changed(const World& world, State& state, int row);
/// World-frame velocity [m/s] that the present control of a row gives at its present pose.
Vec2 velocity_world(const World& world, const State& state, int row);
/// Like the function above, with scratch memory. For drives in Python it is the velocity of the last step.
Vec2 velocity_world(const World& world, const State& state, int row, std::vector<double>& scratch);

/// World-frame velocity [m/s] that a control would give a row at its present pose.
Vec2 velocity_of_control(const World& world, const State& state, int row, Vec3 control, std::vector<double>& scratch);

/// Draw a goal for a wandering object.
void draw_wander_goal(const World& world, State& state, int w, int object);

}  // namespace irsim
