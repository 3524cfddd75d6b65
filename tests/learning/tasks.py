"""Small tasks for tests of learning, and reward functions for them."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

ROBOT: dict[str, Any] = {
    "kinematics": {"name": "diff"},
    "shape": {"name": "circle", "radius": 0.2},
    "state": [1, 5, 0],
    "goal": [9, 5],
    "vel_max": [1, 2],
    "vel_min": [-1, -2],
    "goal_threshold": 0.3,
}
RANDOM = {"name": "random", "range_low": [1, 1, -3], "range_high": [9, 9, 3]}
LIDAR = {"name": "lidar2d", "range_max": 4, "angle_range": 4.7, "number": 45}
NOISY = {**LIDAR, "noise": True, "std": 0.1, "angle_std": 0.01}
PARTS: list[dict[str, Any]] = [{"name": "goal"}, {"name": "own"}]
CHOICES = {"choices": [[0, 0], [1, 0], [0.5, 1], [0.5, -1]]}
EVERYTHING: dict[str, Any] = {
    "number": {"obstacle[0]": [0, 4]},
    "size": {"obstacle[0]": [0.5, 1.5]},
    "speed": {"learners": [0.5, 1.5]},
    "acceleration": {"learners": [0.5, 1.5]},
    "sensor_noise": {"learners": [0, 2]},
    "latency": {"learners": [0, 3]},
}
STARTS: list[dict[str, Any]] = [{"position": 0.5, "heading": "20deg", "objects": ["robot"]}]


def task(*robots: dict[str, Any], obstacles: Any = (), world: Any = None, **keys: Any) -> dict[str, Any]:
    """A task of robots that differ from ``ROBOT`` in some keys."""
    scene = {"world": {"width": 10, "height": 10, "step_time": 0.1, "collision_mode": "stop", **(world or {})}}
    scene["robot"] = [{**ROBOT, **robot} for robot in robots or ({},)]
    if obstacles:
        scene["obstacle"] = list(obstacles)
    given = {"task": "test", "scenario": scene, "observation": PARTS, "reward": [{"name": "progress"}], "horizon": 5}
    return {**given, **keys}


def crowd(number: int = 4, **keys: Any) -> dict[str, Any]:
    """Robots at random places that see one another."""
    parts = [*PARTS, {"name": "neighbors", "count": 3, "range": 5.0}]
    return task({"number": number, "distribution": RANDOM}, observation=parts, **keys)


def lidar_among_boxes(**keys: Any) -> dict[str, Any]:
    """One robot with a lidar at a random place, and boxes."""
    boxes = {"number": 4, "distribution": RANDOM, "shape": {"name": "rectangle", "length": 1, "width": 0.5}}
    parts = [{"name": "scan", "sectors": 9}, *PARTS]
    robot = {"distribution": {**RANDOM, "goal_distance": 3}, "sensors": [LIDAR]}
    return task(robot, obstacles=[boxes], observation=parts, **keys)


def corridor(**keys: Any) -> dict[str, Any]:
    """Two robots in a corridor whose width is drawn."""
    made = task(**{"randomize": {"parameters": {"width": [1.3, 3.3]}, "variants": 5}, **keys})
    del made["scenario"]
    return {**made, "template": "corridor-passing"}


def rich(**keys: Any) -> dict[str, Any]:
    """A robot with a noisy lidar among boxes, of which everything is drawn."""
    made = lidar_among_boxes(**{"randomize": EVERYTHING, **keys})
    made["scenario"]["robot"][0] |= {"sensors": [NOISY], "acce": [2, 4]}
    return made


def of_python(name: str, **keys: Any) -> dict[str, Any]:
    """A reward function of this module."""
    return {"name": "python", "function": f"tests.learning.tasks:{name}", **keys}


def zeros(moment: Any) -> Any:
    return np.zeros(moment.arrived.shape)


def speed(moment: Any) -> Any:
    return np.linalg.norm(moment.velocity, axis=-1)


def chatty(moment: Any) -> Any:
    print("a reward function prints this")
    return moment.distance_before - 2.0 * moment.distance


def picky(moment: Any) -> Any:
    """Fails in processes with two worlds."""
    if len(moment.arrived) == 2:
        raise ZeroDivisionError("there are two worlds", {"number": 2})
    return moment.distance


def deadly(moment: Any) -> Any:
    """Ends a process with two worlds."""
    if len(moment.arrived) == 2:
        os._exit(3)
    return moment.distance
