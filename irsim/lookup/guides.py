"""Short texts about what is no key of a scenario: the program around it, seeds, outcomes."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["GUIDES", "Guide"]


class Guide(NamedTuple):
    """A page of prose, and the words that lead to it."""

    title: str
    text: str
    example: str | None
    words: tuple[str, ...]


GUIDES: dict[str, Guide] = {
    "program": Guide(
        "the Python loop around a scenario",
        "env.step(action, id) advances one period: without action every object follows its behavior; with one, robot "
        "`id` (or a list of ids with a list of actions) gets these controls, limited as in the file: [forward, yaw "
        "rate] for diff, [forward, lateral] for omni, [forward, steering angle] for acker. "
        "env.reset() starts the same layout again; env.reset(random=True) draws the next layout: random places, goals "
        "and shapes, of robots and obstacles alike. With a seed (argument or world.seed) the sequence of layouts is "
        "the same every time, without one it is fresh. env.get_lidar_scan(id)['ranges'] goes from the rightmost beam "
        "to the leftmost; a beam that hits nothing reads range_max; ['radial_velocity'] has "
        "the speeds of an fmcw_lidar2d. env.done() is true when every robot has arrived "
        "or stopped after a collision; env.outcome tells which. A program counts its steps itself: world.time_limit "
        "is for `irsim run` and run_episode.",
        "import irsim\n\nenv = irsim.make('scenario.yaml', seed=1)\nfor _ in range(300):\n    env.step([1.0, 0.2], 0)\n"
        "    if env.done():\n        env.reset(random=True)\nenv.end()",
        ("reset", "env", "env.reset", "env.step", "step", "python", "action", "actions", "policy", "loop", "episode"),
    ),
    "seeds": Guide(
        "what is random, and how to repeat it",
        "Random are: distribution random, shapes with random_shape, wander goals, maps without their own seed, noise. "
        "The same file, seed and version give the same run, bit by bit. The argument seed wins over world.seed; with "
        "neither a fresh one is drawn and reported. A scenario without any of these runs the same with every seed.",
        None,
        ("random", "randomness", "reproducible", "reproduce"),
    ),
    "units": Guide(
        "metres, seconds, radians; x to the right, y up",
        "Lengths are m, times s, speeds m/s, angles radians, masses kg. Heading 0 looks along +x (east) and grows "
        "counter-clockwise: north 1.5708, west 3.1416, south -1.5708. 30 degrees are 0.5236, 45: 0.7854, 90: 1.5708, "
        "360: 6.28318. The lower left corner of the world is (0, 0) unless world.offset says otherwise; objects "
        "do not move with it. A larger width or height adds room at the right and at the top.",
        None,
        ("unit", "radians", "radian", "degrees", "degree", "metres", "meters", "coordinates", "angle", "heading"),
    ),
    "avoidance": Guide(
        "who avoids whom",
        "dash drives straight and avoids nobody. rvo, orca and sfm avoid others and walls (behavior, or group_behavior "
        "for orca and sfm), but find no way round walls: see dead-ends. follow plans one and drives it with one of "
        "these: among walls, cars too, follow with local: {name: orca}. No built-in law is a guarantee: cars cannot "
        "turn on the spot, crowds can jam. orca takes each mover as the circle round its footprint, knows speed and "
        "turn rate but not acce; with walls set its timeHorizonObst to 1 to 2 s. Robots that have arrived give way, "
        "too, and come back.",
        "behavior: {name: follow, local: {name: orca}}",
        ("avoid", "avoid each other", "obstacle avoidance", "collision avoidance", "avoiding"),
    ),
    "dead-ends": Guide(
        "traps, and who gets out of them",
        "dash, rvo, orca and sfm head for the goal and see no farther than what is near: before a concave obstacle "
        "(a U, a corner, a long wall between them and the goal) they stay caught, for good. In such a local minimum "
        "rvo, orca and sfm mostly time out; dash drives into it, which is a collision (collision_mode stop), not a "
        "time-out. follow gets round: it plans on the whole map, also on what no sensor has seen. For a behavior of "
        "your own that must find out by itself, leave behavior away and drive by a program. A car that circles its "
        "goal is another case: inside its turning circle, of radius wheelbase / tan(largest steering angle), a goal "
        "cannot be reached; raise goal_threshold. Template: u-trap.",
        "behavior: {name: follow}",
        (
            *("dead end", "dead-end", "trap", "traps", "trapped", "u-trap", "local minimum", "local minima", "u-shape"),
            *("u shape", "u-shaped", "concave", "cul-de-sac", "stuck", "caught", "turning circle", "circling"),
        ),
    ),
    "limits": Guide(
        "what cannot be simulated",
        "The world is flat and seen from above: no heights, altitude, flying, stairs, ramps, slopes, bridges, falling. "
        "A drone can only stand for one that keeps its height: omni or omni_angular, and nothing passes over or under "
        "it. (unobstructed on the shelves lets it through, but then nothing is tested; on the drone it is no help.) A "
        "side view with y as height is a drawing, not a flight: label it. All is there and moves from t = 0: no start "
        "times, delays, spawning, vanishing, or events at a time. To stagger arrivals start farther away, by speed x "
        "delay (template crossing-pedestrians). Doors and walls "
        "that open at a time or on a signal do not exist; a thing that slides to and fro is an obstacle with "
        "kinematics omni and behavior {name: dash, loop: true}. No weather, slippery floors, speed zones, traffic "
        "lights, right of way, priorities, batteries, radio, cameras or arms; sensors are planar lidars. gravity, "
        "friction and mass are for pushing (collision_mode contact). Say so, and offer the nearest thing, labelled. "
        "(Limits of speed are vel_min, vel_max and acce.)",
        None,
        (
            *("limitations", "not possible", "impossible", "unsupported", "not simulated", "3d", "z", "altitude"),
            *("elevation", "ceiling", "stairs", "stair", "stairway", "ramp", "slope", "hill", "terrain", "bridge"),
            *("fly", "flying", "flight", "drone", "drones", "uav", "quadcopter", "aerial", "jump", "climb", "elevator"),
            *("delay", "delayed", "start_time", "start time", "stagger", "staggered", "spawn", "appear", "disappear"),
            *("schedule", "timer", "weather", "rain", "wind", "snow", "ice", "slippery", "traffic light"),
            *("traffic lights", "priority", "right of way", "battery", "camera", "gripper", "underwater"),
            *("cameras", "depth camera", "rgb camera", "imu", "gps", "boat", "ship", "submarine"),
        ),
    ),
    "things": Guide(
        "how everyday things are written",
        "post, pillar, column, tree, cone: obstacle with shape circle. box, crate, table, shelf, rack, parked car: "
        "rectangle. wall: rectangle, or linestring with state [0, 0, 0]; room: closed linestring. person standing: "
        "obstacle with a circle of 0.2 to 0.3 m and tags: [pedestrian]; walking: with kinematics and behavior as well. "
        "crowd: number 20 or more of them, about 0.3 persons per m2. start and goal are keys of robots: state, goal.",
        "obstacle:\n  - number: 2\n    shape: {name: circle, radius: 0.25}\n    state: [[3, 3, 0], [4, 5, 0]]\n"
        "    tags: [pedestrian]",
        (
            *("post", "pillar", "column", "tree", "box", "crate", "table", "shelf", "rack", "wall", "room", "person"),
            *("people", "pedestrian", "human", "crowd", "crowded"),
        ),
    ),
    "outcomes": Guide(
        "success, collision, timeout",
        "A run ends when every robot has arrived or been stopped by a collision, or at its time limit: the steps asked "
        "for, else world.time_limit, else max(30 s, 4 x the longest way over its goals / that robot's top speed). "
        "success: every robot arrived without a collision before; collision: one was stopped by a collision, or "
        "arrived after one; timeout: neither (where collision_mode lets robots drive on, contacts only count). "
        "Contacts are reported when they begin. Names count robots first, then obstacles: obstacle_3 of a file with "
        "one robot is the third obstacle; pictures shorten it to o3.",
        None,
        ("outcome", "success", "timeout", "time limit", "default time limit", "horizon"),
    ),
}
