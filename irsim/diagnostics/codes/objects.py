"""Codes of objects: their states, goals, motion and sensors, and what they mean together."""

from __future__ import annotations

from irsim.diagnostics.codes.code import Code

__all__ = ["OBJECTS"]

OBJECTS: dict[str, Code] = {
    "duplicate-name": Code(
        "name used twice",
        "Names are unique. With 'number' give a list of names, one per object (the last one is repeated), or none.",
    ),
    "role-mismatch": Code("role does not fit the section", "Robots stand under 'robot', obstacles under 'obstacle'."),
    "too-many-objects": Code(
        "too many objects",
        "A scenario may have 100,000 objects (servers may allow less); the limit can be raised where it is read.",
    ),
    "limits-order": Code("lower limit above upper limit", "vel_min must not exceed vel_max in any component."),
    "angle-range": Code("heading interval is not one turn wide", "angle_range is [low, low + 2π], by default [-π, π]."),
    "invalid-polygon": Code(
        "polygon crosses itself",
        "The corners must go around the polygon once. irsim.make uses the area the outline encloses and warns.",
    ),
    "too-few-vertices": Code("too few vertices", "A polygon has 3 corners or more, a linestring 2 points or more."),
    "goal-levels": Code(
        "list of goals is one goal per object",
        "'goal: [[1, 1], [5, 5]]' gives object 0 the first goal and object 1 the second. Waypoints are written "
        "'waypoints: [[1, 1], [5, 5]]', or with three levels of brackets under 'goal'.",
    ),
    "state-truncated": Code(
        "state has more numbers than rows",
        "The surplus numbers are dropped: three rows, four for acker. A decimal comma makes two numbers of one.",
    ),
    "surplus-states": Code(
        "more states than objects",
        "An entry makes as many objects as 'number' says, one without it. Of a longer list of states, names and the "
        "like the rest is left out. Example: state: [[1, 1, 0], [1, 3, 0], [1, 5, 0]] makes one object; add number: 3.",
    ),
    "default-state": Code(
        "no state given",
        "An object without 'state' stands at [1, 1, 0]. Vertices are in the body frame, so that shifts them by (1, 1); "
        "write 'state: [0, 0, 0]' for vertices in world coordinates.",
    ),
    "default-goal": Code(
        "no goal given", "Every object has a goal; without one of its own it is [1, 9, 0], whatever the world's size."
    ),
    "heading-in-degrees": Code(
        "angle looks like degrees",
        "All angles are in radians: a right angle is 1.5708, half a turn 3.14159, one degree 0.01745. Headings of "
        "several turns, and lidar beams scattered by more than 0.5 rad ('angle_std'), are hardly meant.",
    ),
    "rate-in-degrees": Code(
        "rate of turning looks like degrees",
        "Rates of turning are in radians per second: half a turn a second is 3.14159, 90 degrees a second are 1.5708. "
        "Example: vel_max: [1, 90]; write vel_max: [1, 1.5708].",
    ),
    "speed-in-centimetres": Code(
        "speed looks like centimetres, or km/h",
        "Speeds are in metres per second; 45 m/s are 162 km/h. Example: vel_max: [80, 1] for 80 cm/s; write "
        "vel_max: [0.8, 1], or [22.2, 1] for 80 km/h.",
    ),
    "looks-like-centimetres": Code(
        "length looks like centimetres",
        "Lengths are in metres, and something does not fit into its world or is larger than any vehicle: a body, beams "
        "(range_max), the offset of a sensor, an obstacle's place or corners far outside. Example: shape: {name: "
        "circle, radius: 20} in a world of 10 m; 20 cm are radius: 0.2.",
    ),
    "step-time-long": Code(
        "a step of a second or more",
        "'step_time' is in seconds. Behaviors decide, and collisions are looked for, once per step. Example: "
        "step_time: 100 for 100 ms; write step_time: 0.1.",
    ),
    "default-shape": Code(
        "no shape given", "The default is a circle of radius 1 m, while {name: circle} has radius 0.2 m."
    ),
    "default-vertices": Code("polygon without vertices", "The default is a square of 2 m around the position."),
    "stacked": Code(
        "objects start at the same place",
        "Without a distribution all objects of an entry share its 'state'. Give a list of states, or a distribution. "
        "A hint says that the same obstacle stands in two entries.",
    ),
    "initial-overlap": Code(
        "objects start in collision",
        "Two objects overlap at the start, one of which moves. With 'collision_mode: stop' both stay where they are. "
        "'deep' is the shortest move that would part them; the fix names a free place nearby. Example: a robot of "
        "radius 0.2 at [1, 1] and one at [1.3, 1] are 0.1 m deep in each other.",
    ),
    "goal-reached": Code(
        "goal reached at the start",
        "A goal counts as reached within 'goal_threshold' (0.1 m by default). An object that starts there arrives in "
        "the first step and never moves; waypoints that near to each other count together. With 'arrive_mode: state' "
        "the heading counts too, one radian like one metre. Example: state [1, 1, 0] with goal [1.05, 1]; move the "
        "goal, or lower 'goal_threshold'. Of goals drawn at random most are reached at once where the threshold is as "
        "wide as the ground.",
    ),
    "goal-blocked": Code(
        "no room at the goal",
        "The body overlaps an obstacle or the map wherever within 'goal_threshold' of the goal it might stand, so it "
        "never arrives. The finding says what is there and names a free place nearby. Example: goal [5, 5] in an "
        "obstacle at [5, 5], or a goal 0.1 m from a wall for a robot of radius 0.3.",
    ),
    "goal-unreachable": Code(
        "no way to the goal that is wide enough",
        "A way was looked for among everything that stands still, for the largest disc inside of the body: where that "
        "does not fit, the body cannot. The finding gives the narrowest gap on the widest way, its place, and the "
        "width needed. Example: a door of 0.5 m for a robot of radius 0.3, which needs 0.6 m; widen the door, or "
        "narrow the robot.",
    ),
    "way-unchecked": Code(
        "nobody looked for a way",
        "Ways are looked for with cells of a quarter of a robot's radius or, where the world is too large for that, by "
        "the gaps that things leave. In a world hundreds of times as wide as the robot, with a map whose outline or "
        "obstacles have tens of thousands of corners, neither is done: the goal may be out of reach. "
        "'validate --simulate' with 'behavior: {name: follow}' tells: an event 'no_path' says that there is no way.",
    ),
    "narrow-passage": Code(
        "a gap hardly wider than the robot",
        "The widest way has a gap less than a quarter wider than the body (its largest inner disc). It can be passed, "
        "but behaviors that keep a distance may refuse, and one that is a little off hits the side. It is a warning "
        "where a robot under 'follow' that is alone does not get through, as its planner's cells are too large. "
        "Example: a door of 0.65 m for a robot 0.6 m wide; 0.75 m or more is easier.",
    ),
    "goals-overlap": Code(
        "robots share a place at the end",
        "Last goals are so near to each other that only one robot can stand there; the others push against it or "
        "collide. Often one 'goal' was given for an entry with 'number'. Example: number: 3 with goal: [9, 9]; write "
        "goal: [[9, 9], [9, 7], [9, 5]].",
    ),
    "wander-blocked": Code(
        "random goals in obstacles",
        "The goals of 'wander' are drawn between 'range_low' and 'range_high' without a look at what stands there. An "
        "object whose goal lies in an obstacle, or in a place without a way, never gets a next one. Example: a range "
        "over a whole office; choose one room: range_low: [1, 1], range_high: [4, 4].",
    ),
    "dash-into-obstacle": Code(
        "straight into an obstacle",
        "'dash' drives straight to the goal and looks at nobody, and something stands on that line. Example: an "
        "obstacle at [5, 5] between [1, 1] and [9, 9]; use rvo or orca to get round single round things, and 'follow' "
        "round walls and through buildings.",
    ),
    "needs-planning": Code(
        "a behavior that plans no way round",
        "'rvo', 'sfm' and 'orca' choose a velocity for the next seconds. Before a flat wall, or in a dead end, they "
        "stand still where every step aside leads away from the goal. The finding names that place, or compares the "
        "way round with the straight line. Example: a maze with 'rvo'; write "
        "behavior: {name: follow, planner: astar, local: rvo}, or give waypoints.",
    ),
    "time-too-short": Code(
        "too little time for the way",
        "The shortest way to the last goal, at top speed without a halt, takes longer than the run lasts: until "
        "'world.time_limit', or else 30 s or four times the straight line; 'acce' counts. A hint says that it hardly "
        "suffices. Example: 12 m at 1 m/s with time_limit: 10; write time_limit: 24, or raise vel_max.",
    ),
    "goal-overshoot": Code(
        "steps longer than the goal is wide",
        "'dash' drives at full speed until the goal is within 'goal_threshold'. When one step (vel_max × step_time) "
        "is longer than twice the threshold, the object can hop over its goal, turn, and hop again. Example: 3 m/s × "
        "0.1 s = 0.3 m with goal_threshold 0.1; write goal_threshold: 0.2, or step_time: 0.05. With a "
        "threshold of 0 nothing ever arrives.",
    ),
    "turning-circle": Code(
        "goal inside of the turning circle",
        "A car turns in circles whose radius is its wheelbase over the tangent of its largest steering angle. 'dash' "
        "steers towards a goal inside of such a circle as far as it can and drives round it for ever. Example: "
        "wheelbase 2.6, steering up to 1 rad and a goal 1.2 m to the left; start heading towards it, or write a "
        "larger goal_threshold. 'follow' finds a way.",
    ),
    "static-behavior": Code(
        "behavior of something static",
        "'static: true' keeps an object where it is, whatever its kinematics and behavior say. Remove one of the two.",
    ),
    "no-speed": Code(
        "limits that allow no motion",
        "The behavior wants to drive, but 'vel_min', 'vel_max' or 'acce' allow nothing but rest. For diff and acker "
        "the first number is the speed forwards, for omni the first two are; omni never turns, so it needs the "
        "direction of its goal. Example: vel_max: [0, 1] turns on the spot; write vel_max: [1, 1].",
    ),
    "no-turning": Code(
        "limits that allow no turning",
        "The second number of 'vel_max' and 'vel_min' is the rate of turning (diff) or the steering angle (acker). "
        "Both 0 means straight ahead for ever, so only a goal straight ahead is reached. Example: vel_max: [1, 0]; "
        "write vel_max: [1, 1].",
    ),
    "target-roles-nobody": Code(
        "nobody of the role to avoid",
        "'target_roles' says whom a behavior is shown: all, robot or obstacle. No other object of that role is there "
        "(what is 'unobstructed' does not count), so the behavior avoids nobody. Example: target_roles: robot with one "
        "robot among obstacles; write target_roles: all.",
    ),
    "unobstructed-robot": Code(
        "a robot that others pass through",
        "'unobstructed: true' takes an object out of the way of others: they do not collide with it, and lidars do not "
        "see it. It still collides with what is not 'unobstructed'. Example: a robot that shall drive through a "
        "curtain; write unobstructed: true on the curtain, not on the robot.",
    ),
    "jumps-through": Code(
        "steps longer than what is in the way",
        "Collisions are looked for after each step. An object that moves farther in one step than it and the wall are "
        "thick together can be on one side before and on the other after, without a collision. Example: 20 m/s × 0.1 s "
        "= 2 m against a wall of 0.1 m; lower step_time, or the speed: limits are in m/s.",
    ),
    "circle-overlap": Code("objects on the circle overlap", "The circle is too small for that many objects."),
    "outside-world": Code(
        "start or goal outside the world",
        "Nothing stops objects at the edge; check the numbers of 'state', 'goal' or the 'distribution'. With "
        "'world.boundary: walls' there are walls at the edge, which keep everything in.",
    ),
    "behavior-without-kinematics": Code(
        "behavior without kinematics",
        "What has no kinematics never moves by itself, so its behavior and its goal have no effect.",
    ),
    "no-behavior": Code(
        "robot, or obstacle with a goal, without behavior",
        "It stands still unless the program passes actions to step() or uses the keyboard.",
    ),
    "wander-and-loop": Code("wander and loop together", "wander draws new goals, so loop never applies."),
    "wander-outside": Code(
        "random goals outside the world", "Without range_low and range_high, goals lie within the world."
    ),
    "rvo-acce": Code(
        "rvo's acce is not per second",
        "The object's 'acce' is in m/s². The one of rvo is the change of velocity considered in one step, in m/s.",
    ),
    "speed-capped": Code(
        "the drive is slower than its behavior may want",
        "'vmax' of sfm, 'vxmax' and 'vymax' of rvo and 'maxSpeed' of orca say how fast the behavior may want to be; "
        "the object drives no faster than its 'vel_max' and 'vel_min' allow, 1 by default. Example: behavior: {name: "
        "orca, maxSpeed: 3}; write vel_max: [3, 1] beside it.",
    ),
    "vel-min-default": Code(
        "vel_min keeps its default", "Raising vel_max alone leaves vel_min at -1 for each component."
    ),
    "wheelbase-over-length": Code(
        "axles farther apart than the body is long",
        "The wheelbase is the distance between the axles, and sets the turning circle. Example: length 1 with "
        "wheelbase 2.6; write wheelbase: 0.6.",
    ),
    "wheelbase-default": Code("no wheelbase given", "Ackermann steering without a wheelbase uses 1 m."),
    "omni-noise": Code(
        "noise at standstill", "The noise of omni drives does not depend on speed, so a resting robot trembles."
    ),
    "group-drives-obstacle": Code(
        "group behavior drives an obstacle",
        "A single 'obstacle:' mapping is in group 0, like the first robots, and follows their group behavior. Write "
        "it as a list, or give it its own 'group'.",
    ),
    "group-behavior-unused": Code(
        "group behavior without effect", "The first member of a group (lowest id) decides about its group behavior."
    ),
    "lidar-ends-meet": Code(
        "first and last beam look the same way",
        "Beams are spread over angle_range with both ends included. Over a full turn the ends are one direction, so n "
        "beams look in n - 1 directions: 361 beams are 1 degree apart, 360 beams 1.003. For exactly n directions use "
        "an angle_range of 2π (n - 1) / n, 6.26573 for 360.",
    ),
    "lidar-beams": Code(
        "beams that do not spread", "One beam looks straight ahead, and an angle_range of 0 makes all beams one."
    ),
    "lidar-blind": Code(
        "beams end inside of the robot",
        "A lidar does not see its own robot. Beams that are shorter than the robot's body see nothing before the robot "
        "has hit it. Example: range_max: 0.2 on a robot of radius 0.3; write range_max: 5. Lengths are in metres.",
    ),
    "lidar-noise-off": Code(
        "noise settings without noise", "std and angle_std count only with 'noise: true' (velocity_noise_std always)."
    ),
    "fog-never-lifts": Code(
        "nobody sees anything", "Robots clear the fog: with a lidar, or with 'fov' and 'fov_radius'. Obstacles do not."
    ),
    "fog-too-fine": Code(
        "too many cells of fog", "A fog map has up to 16 million cells: the extent of the world over the cell size."
    ),
    "fov-radius-ignored": Code("fov_radius without fov", "The radius counts only together with 'fov'."),
    "fov-without-radius": Code("fov without fov_radius", "A field of view needs a reach: add 'fov_radius' or a lidar."),
    "contact-without-mode": Code(
        "contact sensor without contacts", "Contact forces exist in 'collision_mode: contact' only."
    ),
    "sample-time": Code(
        "sample_time is not a multiple of step_time", "Frames are drawn every int(sample_time / step_time) steps."
    ),
    "time-limit": Code("time limit below one step", "The run would end before its first step."),
}
"""Codes of objects, alone and together."""
