"""Small tasks for tests of learning."""

from __future__ import annotations

from typing import Any

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
PARTS: list[dict[str, Any]] = [{"name": "goal"}, {"name": "own"}]


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
