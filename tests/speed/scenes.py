"""Scenes whose speed is measured: each makes one part of a step dominate.

Positions come from generators of their own, so that two simulators get the same file whatever their own random streams
do. Keys and values follow IR-SIM 2.12.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

__all__ = ["SCENES", "Scene"]

Mode = Literal["step", "act", "plan", "render", "savefig", "gif", "batch"]
Document = dict[str, Any]


@dataclass(frozen=True)
class Scene:
    """A scene and how it is measured.

    Attributes:
        build: Makes the scenario.
        mode: The timed part: a step; a step with an action after which a learner reads everything; a plan; a frame that
            is not shown; a picture in a file; a frame of an animation; a step of a batch of worlds.
        steps: Steps of an episode.
        agents: Number of robots of one world.
        rays: Number of beams of all sensors of one world.
        worlds: Number of worlds of a batch.
    """

    build: Callable[[], Document]
    mode: Mode = "step"
    steps: int = 50
    agents: int = 1
    rays: int = 0
    worlds: int = 1


def _world(size: float, **others: Any) -> Document:
    return {"width": size, "height": size, "step_time": 0.1, "collision_mode": "unobstructed", **others}


def _ring(count: int, spacing: float) -> tuple[float, list[list[float]], list[list[float]]]:
    """Width of a world, and starts and goals on opposite sides of a circle, at angles that are not quite equal."""
    draw = random.Random(count)
    radius = max(4.0, count * spacing / math.tau)
    size, starts, goals = 2 * radius + 4, [], []
    for k in range(count):
        angle = math.tau * (k + draw.uniform(-0.1, 0.1)) / count
        x, y = radius * math.cos(angle), radius * math.sin(angle)
        starts.append([size / 2 + x, size / 2 + y, angle + math.pi])
        goals.append([size / 2 - x, size / 2 - y, angle + math.pi])
    return size, starts, goals


def _crowd(count: int, spacing: float, drive: str, radius: float, limits: list[float], **others: Any) -> Document:
    size, starts, goals = _ring(count, spacing)
    robots = {
        "number": count,
        "distribution": {"name": "manual"},
        "kinematics": {"name": drive},
        "shape": {"name": "circle", "radius": radius},
        "state": starts,
        "goal": goals,
        "vel_min": [-limit for limit in limits],
        "vel_max": limits,
        "goal_threshold": 0.1,
        **others,
    }
    return {"world": _world(size), "robot": [robots]}


def _rvo(count: int, **others: Any) -> Document:
    behavior = {"name": "rvo", "vxmax": 1.0, "vymax": 1.0, "neighbor_threshold": 3.0}
    return _crowd(count, 0.8, "diff", 0.2, [1.5, 3.0], behavior=behavior, **others)


def _orca(count: int, drive: str = "omni") -> Document:
    behavior = {"name": "orca", "neighborDist": 10.0, "maxNeighbors": 10, "timeHorizon": 5.0, "safe_radius": 0.05}
    return _crowd(count, 1.2, drive, 0.3, [1.5, 2.0 if drive == "diff" else 1.5], group_behavior=behavior)


def _sfm(count: int, key: str) -> Document:
    scene = _crowd(count, 0.8, "diff", 0.25, [1.5, 3.0], **{key: {"name": "sfm", "vmax": 1.0}})
    low, high = 0.5, scene["world"]["width"] - 0.5
    corners = [[low, low], [high, low], [high, high], [low, high], [low, low]]
    scene["obstacle"] = [
        {"shape": {"name": "linestring", "vertices": list(wall)}, "state": [0, 0, 0], "unobstructed": True}
        for wall in pairwise(corners)
    ]
    return scene


def _polygons(draw: random.Random, count: int, size: float, largest: float) -> list[Document]:
    """Convex polygons away from the diagonal of the world."""
    placed = list[Document]()
    while len(placed) < count:
        x, y = draw.uniform(1, size - 1), draw.uniform(1, size - 1)
        if abs(x - y) / math.sqrt(2) < 1.5 + largest:
            continue
        corners, radius = draw.randint(4, 8), draw.uniform(0.3, largest)
        turns = [math.tau * (k + draw.uniform(-0.3, 0.3)) / corners for k in range(corners)]
        vertices = [[radius * math.cos(turn), radius * math.sin(turn)] for turn in turns]
        shape = {"name": "polygon", "vertices": vertices}
        placed.append({"shape": shape, "state": [x, y, draw.uniform(-math.pi, math.pi)]})
    return placed


def _lidar(beams: int, obstacles: int, size: float, reach: float, **others: Any) -> Document:
    robot = {
        "kinematics": {"name": "diff"},
        "shape": {"name": "circle", "radius": 0.2},
        "vel_min": [-1.0, -1.5],
        "vel_max": [1.0, 1.5],
        "state": [1.0, 1.0, math.pi / 4],
        "goal": [size - 1.0, size - 1.0, 0.0],
        "behavior": {"name": "dash"},
        "sensors": [{"name": "lidar2d", "number": beams, "range_max": reach, "angle_range": 6.2}],
        **others,
    }
    largest = 0.6 if size < 15 else 0.8
    obstacle = _polygons(random.Random(100 + obstacles), obstacles, size, largest)
    return {"world": _world(size), "robot": [robot], "obstacle": obstacle}


def _boxes() -> Document:
    scene = _crowd(20, 1.5, "diff", 0.2, [1.0, 1.5], behavior={"name": "dash"}, mass=10.0)
    draw, middle = random.Random(51), scene["world"]["width"] / 2
    scene["world"]["collision_mode"] = "contact"
    scene["obstacle"] = [
        {
            "shape": {"name": "rectangle", "length": 0.5, "width": 0.4},
            "mass": 2.0,
            "friction": 0.3,
            "state": [middle + reach * math.cos(turn), middle + reach * math.sin(turn), draw.uniform(-3.1, 3.1)],
        }
        for turn, reach in ((draw.uniform(-3.1, 3.1), draw.uniform(0.0, 3.5)) for _ in range(20))
    ]
    return scene


def _shown(count: int) -> Document:
    return _rvo(count, plot={"show_trail": True, "show_goal": True, "show_trajectory": True})


_SHOWN_LIDAR = {"show_trajectory": True}
SCENES: dict[str, Scene] = {
    "dash_1": Scene(lambda: _crowd(1, 1.0, "diff", 0.2, [1.0, 1.5], behavior={"name": "dash"})),
    "dash_100": Scene(lambda: _crowd(100, 1.0, "diff", 0.2, [1.0, 1.5], behavior={"name": "dash"}), agents=100),
    "rvo_50": Scene(lambda: _rvo(50), agents=50),
    "orca_50": Scene(lambda: _orca(50), agents=50, steps=100),
    "orca_diff_50": Scene(lambda: _orca(50, "diff"), agents=50, steps=100),
    "orca_200": Scene(lambda: _orca(200), agents=200),
    "sfm_50": Scene(lambda: _sfm(50, "behavior"), agents=50),
    "sfm_200": Scene(lambda: _sfm(200, "behavior"), agents=200, steps=15),
    "sfm_group_200": Scene(lambda: _sfm(200, "group_behavior"), agents=200, steps=30),
    "lidar360_poly100": Scene(lambda: _lidar(360, 100, 50.0, 20.0), rays=360, steps=40),
    "lidar1080_poly500": Scene(lambda: _lidar(1080, 500, 50.0, 20.0), rays=1080, steps=40),
    "contact_20_boxes_20": Scene(_boxes, agents=20),
    "learner_lidar180": Scene(lambda: _lidar(180, 8, 10.0, 7.0), "act", rays=180),
    "plan_astar": Scene(lambda: _lidar(4, 60, 40.0, 5.0), "plan", steps=1),
    "render_rvo10": Scene(lambda: _shown(10), "render", agents=10),
    "savefig_rvo10": Scene(lambda: _shown(10), "savefig", steps=20, agents=10),
    "savefig_lidar360": Scene(lambda: _lidar(360, 20, 20.0, 8.0, plot=_SHOWN_LIDAR), "savefig", steps=20, rays=360),
    "gif_rvo10": Scene(lambda: _shown(10), "gif", agents=10),
    "gif_lidar360": Scene(lambda: _lidar(360, 20, 20.0, 8.0, plot=_SHOWN_LIDAR), "gif", rays=360),
    "gif_rvo10_long": Scene(lambda: _shown(10), "gif", steps=400, agents=10),
    "batch_orca_20": Scene(lambda: _orca(20), "batch", steps=20, agents=20, worlds=256),
    "batch_lidar180": Scene(lambda: _lidar(180, 8, 10.0, 7.0), "batch", steps=20, rays=180, worlds=1024),
}
