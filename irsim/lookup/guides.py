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
        "to the leftmost; a beam that hits nothing reads range_max. env.done() is true when every robot has arrived "
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
        "360: 6.28318. The lower left corner of the world is (0, 0) unless world.offset says otherwise.",
        None,
        ("unit", "radians", "radian", "degrees", "degree", "metres", "meters", "coordinates", "angle", "heading"),
    ),
    "avoidance": Guide(
        "who avoids whom",
        "dash drives straight and avoids nobody. rvo, orca and sfm avoid others and walls (behavior, or group_behavior "
        "for orca and sfm); follow plans a way around walls and drives it with one of these. No built-in law is a "
        "guarantee: cars cannot turn on the spot, and crowds can jam.",
        "behavior: {name: orca}",
        ("avoid", "avoid each other", "obstacle avoidance", "collision avoidance", "avoiding"),
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
        "success: every robot arrived without a collision before; collision: a robot touched something; timeout: "
        "neither. Contacts are reported when they begin. Names count robots first, then obstacles: obstacle_3 of a "
        "file with one robot is the third obstacle; pictures shorten it to o3.",
        None,
        ("outcome", "success", "timeout", "time limit", "default time limit", "horizon"),
    ),
}
