// The template world that Python hands over, object by object.
#pragma once

#include <variant>
#include <vector>

#include "behaviors.gen.hpp"
#include "fields.hpp"
#include "routes/route.hpp"
#include "sensing/timetable.hpp"
#include "sensors.gen.hpp"
#include "shapes.gen.hpp"
#include "world/actuation.hpp"

namespace irsim {

/// Body-frame outlines of the parts of an object. Each part has its own range of draws.
inline std::vector<Outline> draw_outlines(const std::vector<PartSpec>& parts, const Draws& draws) {
  std::vector<Outline> outlines;
  for (const PartSpec& part : parts) {
    const std::uint64_t first = static_cast<std::uint64_t>(outlines.size()) << 32;
    with(part, [&](const auto& shape) { outlines.push_back(outline(shape, draws, first)); });
  }
  return outlines;
}

struct ObjectSpec {
  int number;  // id in draws and events, the same when other objects come and go; -1: index in the list
  int role;    // 0 robot, 1 obstacle
  int group;
  Drive drive;
  std::vector<PartSpec> parts;
  bool is_static, unobstructed, wander, loop;
  std::vector<double> pose, extra, control, vel_min, vel_max, acce, angle_range;
  std::vector<std::vector<double>> goals;
  double goal_threshold;
  int arrive_mode;  // 0 position, 1 state
  std::vector<double> range_low, range_high;
  int target_roles;  // 0 all, 1 robots, 2 obstacles
  Behavior behavior;
  bool grouped;                       // whether the behavior belongs to the group and decides for all members at once
  std::optional<RouteOptions> route;  // how the object plans a path for its behavior to follow
  std::vector<Sensor> sensors;
  std::vector<SensorTiming> timing;  // of each sensor; empty: all measure in each step, and their data arrive at once
  std::vector<double> centroid;      // x, y in the body frame [m], then squared radius of gyration [m^2]; both optional
  double mass, friction, inertia, restitution, tau;  // for contacts; an inertia of NaN follows from shape and mass
  bool driven;                                       // whether the object has a drive, native or in Python
  std::int64_t start_step;                           // steps for which the object stands still at its start
  std::int64_t appear_step;                          // steps for which it is not in the world at all
  std::int64_t vanish_step;                          // step in which it leaves the world; 0: never
  double reflectivity;                               // share of the light of a lidar that its surface throws back
  Material material;
  std::optional<Actuation> actuation;  // without it commands reach the drive as they are
  bool perceives_estimate;             // whether it decides from its estimated pose
  bool perceives_tracks;               // whether it decides from the tracks of its detector

  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using S = ObjectSpec;
    return visit(
        field("number", &S::number), field("role", &S::role), field("group", &S::group), field("drive", &S::drive),
        field("parts", &S::parts), field("static", &S::is_static), field("unobstructed", &S::unobstructed),
        field("wander", &S::wander), field("loop", &S::loop), field("pose", &S::pose), field("extra", &S::extra),
        field("control", &S::control), field("vel_min", &S::vel_min), field("vel_max", &S::vel_max),
        field("acce", &S::acce), field("angle_range", &S::angle_range), field("goals", &S::goals),
        field("goal_threshold", &S::goal_threshold), field("arrive_mode", &S::arrive_mode),
        field("range_low", &S::range_low), field("range_high", &S::range_high), field("target_roles", &S::target_roles),
        field("behavior", &S::behavior), field("grouped", &S::grouped), field("route", &S::route),
        field("sensors", &S::sensors), field("timing", &S::timing), field("centroid", &S::centroid),
        field("mass", &S::mass), field("friction", &S::friction), field("inertia", &S::inertia),
        field("restitution", &S::restitution), field("tau", &S::tau), field("driven", &S::driven),
        field("start_step", &S::start_step), field("appear_step", &S::appear_step),
        field("vanish_step", &S::vanish_step), field("reflectivity", &S::reflectivity),
        choice("material", &S::material, "matt", "glass", "mirror"), field("actuation", &S::actuation),
        field("perceives_estimate", &S::perceives_estimate), field("perceives_tracks", &S::perceives_tracks));
  }
};

/// Objects whose poses and goals are drawn for each scene.
struct RandomPlacement {
  std::vector<int> objects;
  std::array<double, 3> range_low, range_high;   // of starts
  std::array<double, 3> goal_low, goal_high;     // of goals
  double min_distance;                           // between objects, and between goals, of this placement [m]
  double goal_distance;                          // smallest distance from a start to its goal [m]
  std::vector<std::vector<double>> keep_points;  // x, y and radius of the points that footprints keep clear of [m]
  std::vector<int> keep_objects;                 // objects that they keep clear of, at starts and goals,
  std::vector<double> keep_radii;                // and how far from each of them [m]
  int attempts;                                  // maximum number of draws for an object
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using P = RandomPlacement;
    return visit(field("objects", &P::objects), field("range_low", &P::range_low), field("range_high", &P::range_high),
                 field("goal_low", &P::goal_low), field("goal_high", &P::goal_high),
                 field("min_distance", &P::min_distance), field("goal_distance", &P::goal_distance),
                 field("keep_points", &P::keep_points), field("keep_objects", &P::keep_objects),
                 field("keep_radii", &P::keep_radii), field("attempts", &P::attempts));
  }
};

/// Objects that start at random angles of a circle, near it, and cross it to the opposite place.
struct CircleCrossing {
  std::vector<int> objects;
  std::array<double, 2> center;  // [m]
  double radius;                 // of the circle [m]
  double noise;                  // largest change of x and of y of a start [m]
  double clearance;              // smallest distance between footprints, of starts and of goals [m]
  int attempts;                  // maximum number of draws for an object
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using P = CircleCrossing;
    return visit(field("objects", &P::objects), field("center", &P::center), field("radius", &P::radius),
                 field("noise", &P::noise), field("clearance", &P::clearance), field("attempts", &P::attempts));
  }
};

/// Objects that start in the left or right half of a square and end in the other half.
struct SquareCrossing {
  std::vector<int> objects;
  std::array<double, 2> center;  // [m]
  double width;                  // of the square [m]
  double clearance;              // smallest distance between footprints, of starts and of goals [m]
  int attempts;                  // maximum number of draws for a start, and for a goal
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using P = SquareCrossing;
    return visit(field("objects", &P::objects), field("center", &P::center), field("width", &P::width),
                 field("clearance", &P::clearance), field("attempts", &P::attempts));
  }
};

inline const std::vector<int>& placed_objects(
    const std::variant<RandomPlacement, CircleCrossing, SquareCrossing>& placement) {
  return std::visit([](const auto& entry) -> const std::vector<int>& { return entry.objects; }, placement);
}

/// How far the start, the top speed and the time of departure of an object may differ between scenes.
struct Perturbation {
  int object;
  double position;          // largest change of x and of y [m]
  double heading;           // largest change of the heading [rad]
  double speed;             // largest change of the speeds, as a share of them, below 1
  double delay;             // longest time for which the object stands still at its start [s]
  std::vector<int> speeds;  // controls that are speeds
  int attempts;             // maximum number of draws of a start
  template <class Visit>
  static constexpr auto fields(const Visit& visit) {
    using P = Perturbation;
    return visit(field("object", &P::object), field("position", &P::position), field("heading", &P::heading),
                 field("speed", &P::speed), field("delay", &P::delay), field("speeds", &P::speeds),
                 field("attempts", &P::attempts));
  }
  bool moves() const { return position > 0.0 || heading > 0.0; }
};

}  // namespace irsim
