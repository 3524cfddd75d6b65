"""Codes of objects: their states, goals, motion and sensors, and what they mean together."""

from __future__ import annotations

from irsim.diagnostics.codes.code import Code

__all__ = ["OBJECTS"]

OBJECTS: dict[str, Code] = {
    "duplicate-name": Code(
        "name used twice",
        "Names must be unique. With 'number' give a list of names, one each (the last one is repeated), or no name.",
    ),
    "role-mismatch": Code("role does not fit the section", "Robots belong under 'robot', obstacles under 'obstacle'."),
    "too-many-objects": Code(
        "too many objects",
        "A scenario may have 100,000 objects (servers may allow less). A program that reads the scenario can raise "
        "the limit.",
    ),
    "limits-order": Code("lower limit above upper limit", "vel_min must not exceed vel_max in any component."),
    "angle-range": Code(
        "heading interval is not one turn wide", "angle_range must be [low, low + 2π]; the default is [-π, π]."
    ),
    "invalid-polygon": Code(
        "polygon crosses itself",
        "The corners must go around the polygon once. irsim.make uses the area that the outline encloses, with a "
        "warning.",
    ),
    "too-few-vertices": Code("too few vertices", "A polygon needs at least 3 corners, a linestring at least 2 points."),
    "goal-levels": Code(
        "list of goals means one goal per object",
        "'goal: [[1, 1], [5, 5]]' gives object 0 the first goal and object 1 the second. Write waypoints as "
        "'waypoints: [[1, 1], [5, 5]]', or with three levels of brackets under 'goal'.",
    ),
    "state-truncated": Code(
        "state has too many numbers",
        "A state has three numbers, for acker and other drives more; the others are dropped. A decimal comma makes two "
        "numbers of one.",
    ),
    "surplus-states": Code(
        "more states than objects",
        "An entry makes 'number' objects, by default one. Extra elements in a list of states, names and the like "
        "are ignored. Example: state: [[1, 1, 0], [1, 3, 0], [1, 5, 0]] makes one object; add number: 3.",
    ),
    "default-state": Code(
        "no state given",
        "An object without 'state' is placed at [1, 1, 0]. Vertices are in the body frame, so they are shifted by "
        "(1, 1); write 'state: [0, 0, 0]' for vertices in world coordinates.",
    ),
    "default-goal": Code(
        "no goal given", "Every object has a goal. The default is [1, 9, 0], whatever the size of the world."
    ),
    "driven-without-goal": Code(
        "robot of a bridge without a goal",
        "A robot that the program at the other end of a bridge may drive arrives, like any other, at its goal, which "
        "ends the run. Without 'goal' that is [1, 9, 0], a place that was not chosen. Write the goal; where only "
        "the other program knows it, write one out of reach, such as goal: [1000, 0], and the time_limit of the world.",
    ),
    "heading-in-degrees": Code(
        "angle looks like degrees",
        "All angles are in radians: a right angle is 1.5708, half a turn 3.14159, one degree 0.01745. Headings of "
        "several turns, and lidar beams scattered by more than 0.5 rad ('angle_std'), are probably mistakes.",
    ),
    "rate-in-degrees": Code(
        "turning rate looks like degrees",
        "Turning rates are in radians per second: half a turn per second is 3.14159, 90 degrees per second are "
        "1.5708. Example: vel_max: [1, 90]; write vel_max: [1, 1.5708].",
    ),
    "speed-in-centimetres": Code(
        "speed looks like centimetres, or km/h",
        "Speeds are in metres per second; 45 m/s are 162 km/h. Example: vel_max: [80, 1] for 80 cm/s; write "
        "vel_max: [0.8, 1], or [22.2, 1] for 80 km/h.",
    ),
    "looks-like-centimetres": Code(
        "length looks like centimetres",
        "Lengths are in metres, and something does not fit into its world or is larger than any vehicle: a body, "
        "beams (range_max), the offset of a sensor, or an obstacle whose position or corners are far outside. "
        "Example: shape: {name: circle, radius: 20} in a world of 10 m; 20 cm are radius: 0.2.",
    ),
    "step-time-long": Code(
        "step of a second or more",
        "'step_time' is in seconds. Behaviors decide, and collisions are detected, once per step. Example: "
        "step_time: 100 for 100 ms; write step_time: 0.1.",
    ),
    "default-shape": Code(
        "no shape given", "The default is a circle of radius 1 m, while {name: circle} has a radius of 0.2 m."
    ),
    "default-vertices": Code("polygon without vertices", "The default is a square of 2 m around the position."),
    "stacked": Code(
        "objects start at the same place",
        "Without a distribution all objects of an entry share its 'state'. Give a list of states, or a "
        "distribution. If two entries contain the same obstacle, it is a hint.",
    ),
    "initial-overlap": Code(
        "objects start in collision",
        "Two objects, at least one of which can move, overlap at the start. With 'collision_mode: stop' both stay "
        "where they are. 'deep' is measured as min_clearance of a run: how far a circle, or the deepest corner of an "
        "outline, is inside the other. The fix names a free place nearby. "
        "Example: a robot of radius 0.2 at [1, 1] and one at [1.3, 1] are 0.1 m deep in each other. "
        "A start in unknown cells of a map ('unknown: unknown') does not collide, but planners find no way from there.",
    ),
    "goal-reached": Code(
        "goal reached at the start",
        "A goal counts as reached within 'goal_threshold' (0.1 m by default). An object that starts there arrives "
        "in the first step and never moves; waypoints that close to each other count together. With 'arrive_mode: "
        "state' the heading counts too, one radian like one metre. Example: state [1, 1, 0] with goal [1.05, 1]; "
        "move the goal, or lower 'goal_threshold'. Most random goals are reached at once if the threshold is as "
        "large as the area they are drawn from.",
    ),
    "goal-blocked": Code(
        "no free place at the goal",
        "Wherever the body stands within 'goal_threshold' of the goal, it overlaps an obstacle or the map, so it "
        "never arrives. The finding says what is there and names a free place nearby. Example: goal [5, 5] in an "
        "obstacle at [5, 5], or a goal 0.1 m from a wall for a robot of radius 0.3.",
    ),
    "goal-unreachable": Code(
        "no path to the goal that is wide enough",
        "The check searches a path around everything static for the largest disc inside the body: where the disc "
        "does not fit, the body does not either. The finding gives the narrowest gap of the widest path, its place,"
        " and the width needed. Example: a door of 0.5 m for a robot of radius 0.3, which needs 0.6 m; widen the "
        "door, or use a narrower robot. Under 'follow' the path must also stay in 'within' and keep out of 'avoid'.",
    ),
    "way-unchecked": Code(
        "paths were not checked",
        "The check searches paths on cells of a quarter of a robot's radius or, where the world is too large for "
        "that, through the gaps between objects. In a world hundreds of times as wide as the robot, with a map "
        "whose outline or obstacles have tens of thousands of corners, neither is possible, so the goal may be out "
        "of reach. To find out, use 'validate --simulate' with 'behavior: {name: follow}': an event 'no_path' means"
        " that there is no path.",
    ),
    "narrow-passage": Code(
        "gap hardly wider than the robot",
        "The widest path has a gap less than a quarter wider than the body (its largest inner disc). The finding "
        "gives the narrowest gaps on the way that the robot drives, like the table of a picture. The robot can "
        "pass, but behaviors that keep a distance may refuse, and small deviations hit the side. It is a warning"
        " if a single robot under 'follow' does not get through because its planner's cells are too large. Example:"
        " a door of 0.65 m for a robot 0.6 m wide; 0.75 m or more is easier.",
    ),
    "goals-overlap": Code(
        "robots have the same final place",
        "Final goals are so close to each other that only one robot can stand there; the others push against it or "
        "collide. Often one 'goal' was given for an entry with 'number'. Example: number: 3 with goal: [9, 9]; "
        "write goal: [[9, 9], [9, 7], [9, 5]].",
    ),
    "wander-blocked": Code(
        "random goals in obstacles",
        "The goals of 'wander' are drawn between 'range_low' and 'range_high' without regard to obstacles. An "
        "object whose goal is in an obstacle, or in a place it cannot reach, never gets another goal. Example: a "
        "range over a whole office; choose one room: range_low: [1, 1], range_high: [4, 4].",
    ),
    "dash-into-obstacle": Code(
        "straight line to the goal is blocked",
        "'dash' drives straight to the goal and avoids nothing, and an obstacle is on that line. Example: an "
        "obstacle at [5, 5] between [1, 1] and [9, 9]; use rvo or orca to pass single obstacles, and 'follow' out of "
        "dead ends and through buildings. It is a hint, and a warning once a simulated try has collided.",
    ),
    "needs-planning": Code(
        "behavior does not plan a path around obstacles",
        "'rvo', 'sfm', 'orca' and 'avocado' choose a velocity for the next seconds. They pass single obstacles, but "
        "in a dead end they stop where every step aside leads away from the goal. The finding names that place, or "
        "compares the path around the obstacle with the straight line. Example: a maze with 'rvo'; write behavior: "
        "{name: follow, planner: astar, local: rvo}, or give waypoints.",
    ),
    "time-too-short": Code(
        "too little time for the path",
        "The shortest path to the last goal, at top speed without a stop, takes longer than the run lasts: "
        "'world.time_limit', or else 30 s or four times the straight line, whichever is longer; 'acce' counts. If "
        "it barely suffices, it is a hint. Example: 12 m at 1 m/s with time_limit: 10; write time_limit: 24, or "
        "raise vel_max.",
    ),
    "goal-overshoot": Code(
        "steps longer than the goal is wide",
        "When one step (vel_max × step_time) is longer than twice 'goal_threshold', an object can jump over its goal, "
        "turn, and jump over it again: no behavior slows down so much that a step must end at the goal. "
        "Example: 3 m/s × 0.1 s = 0.3 m with goal_threshold 0.1; write goal_threshold: 0.2, or step_time: 0.05. "
        "With a threshold of 0 no object ever arrives. A car, which cannot turn on the spot, needs a goal_threshold of "
        "a whole step; else it is a warning: under 'dash' it may circle its goal, under 'follow' it shunts back and "
        "forth there, and without reverse it may never get there.",
    ),
    "door-jam": Code(
        "robots can jam in a narrow passage",
        "Several robots under 'follow' drive through a passage in which no two of them have room side by side. "
        "With the local behaviors 'rvo' and 'sfm' they push into it together and can stand there for ever; with "
        "'orca' they give way by the rest of their paths and pass one after the other. Example: three robots of 0.5 m "
        "and a door of 0.9 m; write local: {name: orca}.",
    ),
    "crowd-stops": Code(
        "people who stop for good when they touch",
        "Under 'sfm' people push each other away, but now and then they touch, whatever the safety_radius. In "
        "collision_mode stop, the default, a contact stops both for good, so a crowd freezes bit by bit. With "
        "unobstructed_obstacles people walk on and only robots stop, with unobstructed nothing stops; contacts are "
        "counted all the same. People with 'orca' do not touch.",
    ),
    "region-left": Code(
        "start or goal outside the region of follow",
        "Under `within` the path of `follow` stays in a region. To a goal outside it there is no path, and the object "
        "stays where it is.",
    ),
    "ends-in-zone": Code(
        "start or goal in a zone that follow avoids",
        "The zones that `avoid` of `follow` names are solid for the object. A goal in one of them has no path to it, "
        "and the object stays where it is; from a start in one of them it drives out first. The whole body counts: its "
        "radius must fit between the place and the zone.",
    ),
    "keep-clear": Code(
        "keep_clear that cannot be kept",
        "A random place can keep clear of points, and of the starts and goals of objects of other entries. Objects of "
        "circle_crossing and square_crossing do not make way, so their entries must come first; robots are placed "
        "before obstacles.",
    ),
    "circle-overlap": Code("objects on the circle overlap", "The circle is too small for that many objects."),
    "outside-world": Code(
        "start or goal outside the world",
        "Objects do not stop at the edge; check the numbers of 'state', 'goal' or the 'distribution'. A goal nearer to "
        "the edge than the radius of the body is inside, but the body then reaches over the edge. With "
        "'world.boundary: walls' there are walls at the edge, which keep everything inside.",
    ),
    "zone-outside-world": Code(
        "zone outside the world",
        "A zone of 'world.zones' lies entirely outside the world, so that only objects that leave the world can reach "
        "it. Example: line: [[5, 14], [5, 16]] in a world of 10 m; write line: [[5, 4], [5, 6]].",
    ),
    "behavior-without-kinematics": Code(
        "behavior without kinematics",
        "An object without kinematics never moves, so its behavior and its goal have no effect.",
    ),
    "no-behavior": Code(
        "robot, or obstacle with a goal, without behavior",
        "The object stays in place unless the program passes actions to step() or uses the keyboard.",
    ),
    "wander-and-loop": Code("wander and loop together", "wander draws new goals, so loop has no effect."),
    "wander-outside": Code(
        "random goals outside the world", "Without range_low and range_high, goals are drawn within the world."
    ),
    "policy-unsuited": Code(
        "a policy outside the scenes that it is for",
        "Each policy has a card with the scenes that it was trained in, or that its law is made for. A trained policy "
        "knows nothing else: one that has never seen a pillar drives into it. 'irsim policies --for FILE' compares the "
        "scene with all cards and ranks the policies; a benchmark measures them.",
    ),
    "rvo-acce": Code(
        "rvo's acce is not per second",
        "The object's 'acce' is in m/s². The 'acce' of rvo is the change of velocity considered in one step, in m/s.",
    ),
    "speed-capped": Code(
        "drive slower than its behavior may want",
        "'vmax' of sfm, 'vxmax' and 'vymax' of rvo and 'maxSpeed' of the kinds of orca limit the speed that the "
        "behavior wants; the object drives no faster than its 'vel_max' and 'vel_min' allow, 1 by default. Example: "
        "behavior: {name: orca, maxSpeed: 3}; write vel_max: [3, 1] beside it.",
    ),
    "exact-symmetry": Code(
        "starts too symmetric to pass each other",
        "One with orca, or with avocado without noise, straight behind a slower one trails it; 'sidestep: 10' makes it "
        "pass on the right. Two that meet head-on, or a ring, pass on their right by themselves, except with "
        "'sidestep: 0', the law of IR-SIM, except under sfm in rings of bodies that are 4 m wide side by side "
        "(footprint_orca passes), and except for cars under rvo and sfm (follow with local: {name: footprint_orca} "
        "passes). Example: behavior: {name: orca, sidestep: 10}.",
    ),
    "vel-min-default": Code(
        "vel_min keeps its default", "Raising vel_max alone leaves vel_min at -1 for each component."
    ),
    "wheelbase-over-length": Code(
        "axles farther apart than the body is long",
        "The wheelbase is the distance between the axles and determines the turning circle. Example: length 1 with "
        "wheelbase 2.6; write wheelbase: 0.6.",
    ),
    "wheelbase-default": Code("no wheelbase given", "Ackermann steering without a wheelbase uses 1 m."),
    "omni-noise": Code(
        "noise at standstill", "The noise of omni drives does not depend on speed, so a robot at rest trembles."
    ),
    "group-drives-obstacle": Code(
        "group behavior drives an obstacle",
        "A single 'obstacle:' mapping is in group 0, like the first robots, and follows their group behavior. Write "
        "it as a list, or give it its own 'group'.",
    ),
    "group-behavior-unused": Code(
        "group behavior without effect", "The first member of a group (lowest id) determines its group behavior."
    ),
    "lidar-ends-meet": Code(
        "first and last beam have the same direction",
        "Beams are spread over angle_range with both ends included. Over a full turn the ends are one direction, so"
        " n beams have n - 1 directions: 361 beams are 1 degree apart, 360 beams 1.003. For exactly n directions "
        "set endpoint: false.",
    ),
    "lidar-beams": Code(
        "beams that do not spread", "A single beam points straight ahead, and an angle_range of 0 makes all beams one."
    ),
    "lidar-blind": Code(
        "beams end inside the robot",
        "A lidar does not see its own robot. Beams shorter than the robot's body see nothing before the robot has "
        "hit it. Example: range_max: 0.2 on a robot of radius 0.3; write range_max: 5. Lengths are in metres.",
    ),
    "lidar-too-short": Code(
        "lidar that sees less far than its robot needs to stop",
        "A thing that comes into reach of a lidar at top speed must be farther away than the way to a stand: one "
        "step, 'rate' and 'latency' of the lidar and the 'actuation' of the robot pass before it brakes by 'acce'. "
        "With 'range_dark' of 'realism', or of a 'device', the darkest object ('reflectivity') counts. Behaviors know "
        "what stands without a lidar; policies and programs that go by it need one that sees farther, or less speed. "
        "Example: range_max: 1 at 2 m/s with acce: [1, 2]; write range_max: 5.",
    ),
    "lidar-noise-off": Code(
        "noise settings without noise",
        "std and angle_std have an effect only with 'noise: true' (velocity_noise_std always has).",
    ),
    "fog-never-lifts": Code(
        "no robot can see", "Robots clear the fog with a lidar, or with 'fov' and 'fov_radius'. Obstacles do not."
    ),
    "cliff-without-zones": Code(
        "no drop for a cliff sensor", "The sensor 'cliff' sees a drop in the regions that its key 'zones' names."
    ),
    "fog-too-fine": Code(
        "too many cells of fog", "A fog map may have 16 million cells: the extent of the world over the cell size."
    ),
    "fov-radius-ignored": Code("fov_radius without fov", "The radius has an effect only together with 'fov'."),
    "fov-without-radius": Code("fov without fov_radius", "A field of view needs a range: add 'fov_radius' or a lidar."),
    "contact-without-mode": Code(
        "contact sensor without contacts", "Contact forces exist only in 'collision_mode: contact'."
    ),
    "sample-time": Code(
        "sample_time is not a multiple of step_time", "Frames are drawn every int(sample_time / step_time) steps."
    ),
    "time-limit": Code("time limit below one step", "The run would end before its first step."),
}
"""Codes of objects, alone and together."""
