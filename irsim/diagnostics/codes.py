"""The closed list of diagnostic and error codes: name, one-line title, explanation shown by ``irsim describe CODE``."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["CODES", "TOOL_CODES", "Code"]


class Code(NamedTuple):
    """A documented code."""

    title: str
    explanation: str


CODES: dict[str, Code] = {
    # the file
    "file-not-found": Code(
        "scenario file not found",
        "No file of that name in the places searched: as given, below sys.path[0], below the current directory, beside "
        "the running script. The message lists them and files with similar names.",
    ),
    "not-a-file": Code(
        "not a regular file", "The path names a directory, a device or a pipe. Name the YAML file itself."
    ),
    "image-not-found": Code(
        "image of a description not found",
        "`description` names an image that is drawn instead of the shape: a file beside the scenario or the script, or "
        "a bundled one. Without it the shape is drawn. Addresses such as http: are not fetched.",
    ),
    "unreadable": Code("file cannot be read", "The system refuses to read the file: check permissions and the path."),
    "not-text": Code("not a text file", "The file holds bytes that are not UTF-8 text. Save the scenario as UTF-8."),
    "file-too-large": Code(
        "file too large",
        "Scenarios are limited to 16 MiB (servers may allow less). Groups of objects are written with 'number' and "
        "'distribution' instead of one entry each.",
    ),
    "path-outside-workspace": Code(
        "path leads out of the workspace",
        "The program is confined to a folder, as irsim-mcp is to its --workspace. Scenarios, and the maps and pictures "
        "they name, lie in it and are named by paths relative to it (or to the scenario): no '..', no absolute path, "
        "no link that leads out, no device.",
    ),
    # YAML
    "yaml-syntax": Code(
        "not valid YAML",
        "The text does not follow YAML's grammar at this place; the cause is often a line earlier: a missing ':', an "
        "unclosed bracket or quote, a tab, or uneven indentation.",
    ),
    "empty-document": Code("nothing in the file", "The file holds only blanks or comments. A scenario is a mapping."),
    "multiple-documents": Code(
        "more than one YAML document", "A line '---' starts a second document. One file holds one scenario."
    ),
    "not-a-scenario": Code(
        "not a scenario",
        "The file is valid YAML, but a list or a single value. A scenario is a mapping with the keys world, robot, "
        "obstacle, gui, custom.",
    ),
    "duplicate-key": Code(
        "key given twice", "A mapping has the same key twice. YAML keeps the last value; keep one of them."
    ),
    "bad-key": Code("not usable as a key", "Keys are words. Lists and mappings cannot be keys; '<<' merges mappings."),
    "unsupported-tag": Code(
        "YAML tag not supported",
        "Tags such as !!python/object construct program objects; other programs would run them. Here a scenario is "
        "plain data: tags are never executed, only reported. Remove the tag, and its value if it makes no sense alone.",
    ),
    "recursive-alias": Code(
        "alias inside its own anchor", "The value would contain itself without end. Write it out instead."
    ),
    "alias-expansion": Code(
        "aliases expand to too much",
        "Aliases (*name) and merge keys (<<) repeat so much that the scenario would not fit into memory.",
    ),
    "too-many-events": Code("too many values", "The file holds more values and brackets than are read (2 million)."),
    "too-deep": Code("nested too deeply", "Lists and mappings are nested more than 64 levels deep."),
    "yaml-number-text": Code(
        "number that YAML 1.1 reads as text",
        "In YAML 1.1 a float has a point, its exponent a sign, and a digit stands between sign and point: 1e3 and -.5 "
        "are text, 1.0e+3, 1000 and -0.5 are numbers.",
    ),
    "yaml-boolean": Code(
        "word that YAML 1.1 reads as a boolean",
        "yes, no, on, off, true and false are booleans unless quoted. Quote the word to keep it as text.",
    ),
    "yaml-sexagesimal": Code(
        "number in base 60",
        "YAML 1.1 reads 12:30:45 as 45045, counting in sixties. Quote it for text, or write the number.",
    ),
    "yaml-octal": Code(
        "octal number", "YAML 1.1 reads a number that starts with 0, such as 010, in base 8. Drop the leading zero."
    ),
    # keys and values
    "unknown-key": Code(
        "unknown key",
        "The key is not part of the language at this place; 'allowed' lists those that are. IR-SIM 2.12 ignores most "
        "of them: irsim.make and irsim run do so too and warn, everything strict refuses.",
    ),
    "missing-key": Code("key missing", "This mapping needs the key; there is no default for it."),
    "conflicting-keys": Code("keys exclude each other", "Two keys say the same thing in different ways. Keep one."),
    "ignored-key": Code("key without effect", "Another key of the same entry makes this one meaningless."),
    "wrong-type": Code(
        "value of the wrong kind",
        "The key takes another kind of value, such as a number instead of text; 'allowed' says which.",
    ),
    "wrong-length": Code(
        "wrong number of elements",
        "A vector has too few or too many numbers. Poses are [x, y] or [x, y, theta]; vel_min, vel_max, acce and "
        "velocity have one number per control component of the kinematics.",
    ),
    "scalar-list": Code(
        "list where one number belongs",
        "A list of plain numbers is one vector for all objects, so keys that take a single number cannot be given per "
        "object (mass, friction, inertia and restitution can). Write one entry per value. In 'state' and 'goal' it "
        "means one level of brackets too many.",
    ),
    "not-a-mapping": Code(
        "mapping expected", "Features are mappings with a name: 'kinematics: {name: diff}', not 'kinematics: diff'."
    ),
    "unknown-value": Code("unknown word", "The key takes one of a fixed set of words; 'allowed' lists them."),
    "invalid-value": Code("invalid value", "The value does not fit; the message says why."),
    "out-of-range": Code("number out of range", "The number is outside the bounds of this key; 'allowed' has them."),
    "range-order": Code(
        "bounds in the wrong order", "The lower bound of a range must not be greater than the upper one."
    ),
    "infinite-number": Code("infinity not allowed", "Only acce, mass and inertia may be infinite (.inf)."),
    "not-a-number": Code("NaN not allowed", "Not-a-number has no meaning in a scenario. Give a number."),
    "angle-over-full-turn": Code(
        "angle larger than a full turn",
        "Opening angles go from 0 to 2π = 6.28318 radians. A value such as 90, 180 or 360 is probably in degrees.",
    ),
    "unknown-color": Code(
        "unknown color",
        "Colors are names ('red', 'tab:blue', 'xkcd:sky blue'), '#RRGGBB', a grey level as text ('0.5'), or [r, g, b] "
        "with numbers from 0 to 1.",
    ),
    # names of features
    "unknown-behavior": Code(
        "unknown behavior",
        "No behavior of that name is built in or registered for the object's kinematics. User code registers its own "
        "with irsim.register_behavior before the scenario is read: in a Python program, or by --import MODULE of the "
        "command line. Random goals and rounds are no behaviors but keys of every one: {name: dash, wander: true}, "
        "{name: dash, loop: true}.",
    ),
    "behavior-for-other-drive": Code(
        "behavior registered for other kinematics",
        "User code registered this behavior, but not for the kinematics of this object. Register it for these too.",
    ),
    "not-a-group-behavior": Code(
        "not a group behavior", "This behavior decides for each object alone: write it under 'behavior'."
    ),
    "bad-social-group": Code(
        "social group of members that are not there, or named twice",
        "'social_groups' of a group 'sfm' lists who walks together, by the index of each member in its group, counted "
        "from 0 in the order of the file. Each index is below the number of members and is named once.",
    ),
    "unknown-kinematics": Code("unknown kinematics", "No drive of that name is built in or registered."),
    "unknown-shape": Code("unknown shape", "No shape of that name is built in or registered."),
    "unknown-sensor": Code("unknown sensor", "No sensor of that name is built in or registered."),
    "unknown-distribution": Code("unknown distribution", "No distribution of that name is built in or registered."),
    "unknown-map": Code("unknown map generator", "No map generator of that name is built in or registered."),
    "unknown-planner": Code("unknown planner", "No path planner of that name is built in or registered."),
    "unknown-object": Code("unknown object", "No object of the scenario has that name."),
    # objects
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
    # maps
    "map-not-found": Code(
        "map file not found",
        "Maps are looked for as given, beside the scenario, below sys.path[0], beside the running script, and among "
        "the bundled ones: cave.png, office.png, maze.png, flat_1.png, flat_2.png.",
    ),
    "map-unreadable": Code(
        "map file cannot be read",
        "A map is a picture that Pillow reads (PNG, PGM, JPEG, BMP, ...), black where it is occupied. A ROS map is a "
        "YAML file with the keys image, resolution and origin.",
    ),
    "map-too-large": Code(
        "map too large",
        "Maps have up to 64 million cells, 256 MiB as files; servers allow less. Scale the picture down: cells of "
        "5 cm are fine enough for most robots.",
    ),
    "map-empty": Code(
        "map without walls", "No cell is occupied, so there is no map object. Black is occupied, white is free."
    ),
    "map-full": Code("map without room", "Every cell is occupied. Black is occupied, white is free."),
    "map-values": Code(
        "not an occupancy grid", "A map given as an array has the shape (nx, ny) and holds numbers from 0 to 100."
    ),
    "map-generator": Code(
        "map generator failed", "The Python class registered under this name raised an exception, or gave no grid."
    ),
    "no-map": Code("no map", "The scenario has no 'world.obstacle_map', so there is nothing to export."),
    "map-stand-in": Code(
        "another map is used",
        "The indoor scans of IR-SIM may not be handed on; flats of our own stand in for them under the same names.",
    ),
    # engine
    "not-yet-simulated": Code(
        "valid, but not simulated yet",
        "The language knows the feature; this version's engine does not run it, and says so instead of leaving it out.",
    ),
    "too-large": Code(
        "number beyond any world",
        "Lengths and places of more than 1e7 m, and speeds beyond 1e7 m/s, drown in rounding. Lengths are in metres.",
    ),
    "placement-impossible": Code(
        "more objects than fit",
        "The objects of this entry keep a distance (twice the radius, or 'min_distance'), and no arrangement of "
        "so many points fits into the range. No seed and no other order can help: fewer, smaller, or more room.",
    ),
    "placement-tight": Code(
        "random placement is likely to fail",
        "Objects that are dropped one after another jam when they cover about half of the ground. Some seeds may "
        "succeed, most end with 'placement-crowded'. irsim validate tries 20 seeds and says how many fail.",
    ),
    "heading-not-reached": Code(
        "the goal's heading is not steered for",
        "With 'arrive_mode: state' an arrival needs position and heading. Under every built-in behavior 'omni_angular' "
        "turns to the goal's heading, once it is within 'goal_threshold' of the place; other drives stop with the "
        "heading they came with and do not arrive.",
    ),
    "steering-limit": Code(
        "steering angle beyond a quarter turn",
        "The second control of 'acker' is the steering angle in radians, in mode 'steer', and 'psi_max' the largest in "
        "any mode. Wheels turned by more than 1.5708 drive backwards; 30 degrees are 0.5236.",
    ),
    "placement-crowded": Code(
        "random placement found no room",
        "No free pose was found within the attempts. Fewer or smaller objects, a larger range, or a smaller "
        "min_distance make room.",
    ),
    "too-many-problems": Code("more problems than are shown", "Mend the first ones and validate again."),
}

TOOL_CODES: dict[str, Code] = {
    "unknown-template": Code("unknown template", "No template of that name is bundled; irsim templates lists them."),
    "unknown-parameter": Code(
        "unknown parameter", "The template has no parameter of that name; irsim describe NAME lists them."
    ),
    "bad-parameter": Code(
        "parameter not accepted", "The value is of the wrong type or out of range; the message says what is accepted."
    ),
    "unknown-skill": Code(
        "unknown skill", "This package has no skill for agents of that name; irsim skills list shows them."
    ),
    "unknown-topic": Code(
        "unknown topic", "Neither the language nor its components, templates and codes have that name."
    ),
    "unknown-format": Code(
        "unknown file format", "The suffix of the file says what to write; the message lists the suffixes known."
    ),
    "file-exists": Code("file exists", "Nothing is overwritten unless asked to with --force."),
    "import-failed": Code(
        "module cannot be imported", "A module named by --import raised an error; the message has it."
    ),
    "behavior-failed": Code(
        "behavior of your own failed",
        "A behavior written in Python raised an error, or did not return finite numbers, one per control component.",
    ),
    "invalid-input": Code("input not usable", "The message says what is wrong with it."),
    "file-access": Code(
        "file cannot be read or written", "The system refuses: check the path, the permissions and the space left."
    ),
    "out-of-memory": Code("not enough memory", "Fewer objects, beams or frames need less."),
    "unknown-run": Code(
        "unknown run",
        "No recorded run of that id is kept in the workspace. Runs are let go 24 hours after their last use, and the "
        "least recently used ones when all together exceed 500 MB; the message names recent ones.",
    ),
    "unknown-job": Code(
        "unknown job",
        "No job of that id is kept in the workspace. Jobs are let go after 24 hours; the message names recent ones.",
    ),
    "unreadable-run": Code(
        "run cannot be read", "A file of the recorded run has been changed, removed or cut; record the run again."
    ),
    "step-out-of-range": Code(
        "step outside the run", "The recorded run has no such step; the message has the steps it does have."
    ),
    "unknown-tool": Code("unknown tool", "The server has no tool of that name; the message names the nearest."),
    "unknown-prompt": Code("unknown prompt", "The server has no prompt of that name; the message lists those it has."),
    "unknown-argument": Code(
        "unknown argument", "The tool has no argument of that name; the message names the nearest, or all there are."
    ),
    "bad-argument": Code(
        "argument not accepted",
        "An argument of the call is of the wrong type, out of range, or does not fit the others.",
    ),
    "invalid-scenario": Code(
        "scenario with errors",
        "Nothing was run or drawn. The message has the first problems; validate_scenario (irsim validate) lists all, "
        "with a fix for each.",
    ),
    "over-limit": Code(
        "more work than is allowed",
        "The message has the limit and what was asked for. Fewer steps or objects need less.",
    ),
    "out-of-time": Code(
        "time of computation is over",
        "The work was stopped. A run is recorded until then, see inspect_run; of other work nothing is kept. Fewer "
        "steps, objects or lidar beams take less time.",
    ),
    "busy": Code(
        "too much at once", "As many calls are being worked on as the server allows. Call again a little later."
    ),
    "worker-failed": Code(
        "worker process died", "The process that did the work ended without a result; the server itself goes on."
    ),
    "internal-error": Code(
        "unexpected error",
        "A mistake in irsim or in user code; IRSIM_TRACEBACK=1 shows where. Please report it if it is ours.",
    ),
}
"""Codes of errors outside scenarios: of the command line and other tools."""
