// The ways on which objects with limited acceleration come to rest.
#pragma once

#include <vector>

#include "geometry/vec.hpp"

namespace irsim {

struct State;
struct World;
struct Workspace;

/// The way of one mover from now until it stands, world frame.
struct Stop {
  int first = 0, count = 0;  // centres of its bounding circle: points of `Stops`, the present one first
  double bulge = 0.0;        // largest distance of these centres from the line between the first and the last [m]
  double radius = 0.0;       // of the bounding circle [m]
  bool plans = false;        // whether it keeps to its side of the borders to other objects, too
};

/// The ways of the movers of one world in the snapshot of a step: scratch memory.
struct Stops {
  bool known = false;         // whether it holds the present step
  std::vector<Stop> of;       // (movers,) by index in World::moving
  std::vector<Vec2> points;   // [m]
  std::vector<Vec2> trial;    // centres on the way of a control that is tried [m]
  std::vector<double> extra;  // copy of a row of State::extra
  struct Border {
    Vec2 normal;
    double offset;  // [m]
  };
  std::vector<Border> borders;  // of the object that decides: its centre c stays where dot(normal, c) <= offset
};

/// Whether an object with this behavior brakes in time: it avoids others, and nothing else sees to that.
bool brakes_in_time(const World& world, int object);
/// Whether an object cannot change its speed at once.
bool is_inert(const World& world, const State& state, int row, int object);

/// The control that brakes: zero, but wheels that are steered keep their present angle. The way on which an object
/// comes to rest with it is the one that others leave free, and that is free of walls.
///
/// Args:
///   steering: The present angle of these wheels [rad].
Vec3 braking_control(const Drive& drive, double steering);

/// The stops of world w, which the first call of a step computes.
Stops& stops(const World& world, const State& state, Workspace& work, int w);

/// Write the centres of the bounding circle of an object after one period with `wanted`, as far as its limits allow,
/// and after each of the following periods in which it brakes until it stands.
void stop_after(const World& world, const State& state, int row, int object, const Vec3& wanted,
                std::vector<double>& extra, std::vector<Vec2>& centres);

}  // namespace irsim
