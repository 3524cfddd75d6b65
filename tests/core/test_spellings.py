"""Walls are walls however they are written: the same outline gives the same motion, and a way past what stands free."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import yaml
from hypothesis import strategies as st
from PIL import Image

import irsim
from irsim.env import Env
from irsim.scenario.read import read
from tests.core.worlds import assert_success
from tests.effort import for_all

BEHAVIORS = ["rvo", "sfm", "orca", "avocado", "footprint_orca"]
DRIVES = ["diff", "omni", "omni_angular", "acker"]
EQUAL = 1e-6
"""Largest distance [m] between runs among different spellings: rounding errors, which motion amplifies."""

Corners = list[list[float]]


def line(corners: Corners) -> dict[str, Any]:
    return {"name": "linestring", "vertices": [*corners, corners[0]]}


def polygon(corners: Corners) -> dict[str, Any]:
    return {"name": "polygon", "vertices": corners}


def box(length: float, width: float) -> Corners:
    x, y = length / 2, width / 2
    return [[-x, -y], [x, -y], [x, y], [-x, y]]


def spellings_of_a_box(length: float, width: float) -> list[dict[str, Any]]:
    part = {"name": "rectangle", "width": width}
    halves = [
        {**part, "length": 0.7 * length, "pose": [-0.15 * length, 0, 0]},
        {**part, "length": 0.6 * length, "pose": [0.2 * length, 0, 0]},
    ]
    return [
        {"name": "rectangle", "length": length, "width": width},
        polygon(box(length, width)),
        polygon(box(length, width)[::-1]),
        line(box(length, width)),
        line(np.roll(box(length, width), 1, axis=0).tolist()[::-1]),
        {"name": "compound", "parts": halves},
    ]


def scene(behavior: str, drive: str, shape: dict[str, Any], pose: list[float], start: float = 0.0) -> dict[str, Any]:
    robot = {
        "kinematics": {"name": drive, **({"wheelbase": 0.2} if drive == "acker" else {})},
        "shape": {"name": "circle", "radius": 0.2},
        "state": [3, 10 + start, 0],
        "goal": [17, 10],
        "goal_threshold": 0.2,
        "group_behavior" if behavior in ("orca", "avocado", "footprint_orca") else "behavior": {"name": behavior},
    }
    obstacle = {"shape": shape, "state": pose}
    return {"world": {"width": 20, "height": 20, "time_limit": 90}, "robot": robot, "obstacle": obstacle}


def with_map(data: dict[str, Any], picture: np.ndarray, folder: Path) -> dict[str, Any]:
    """The scene with a picture of its walls in place of obstacles."""
    Image.fromarray(picture).save(folder / "map.png")
    mapped = {**data, "world": {**data["world"], "obstacle_map": str(folder / "map.png")}}
    del mapped["obstacle"]
    return mapped


def trace(data: dict[str, Any], steps: int) -> np.ndarray:
    """(steps, 3) poses of the robot."""
    env = Env(read(data).scenario, headless=True, seed=0)
    poses = []
    for _ in range(steps):
        env.step()
        poses.append(env.robot.state[:3, 0])
    env.end(0)
    return np.array(poses)


def assert_equal(data: list[dict[str, Any]], steps: int) -> None:
    """Runs are equal but for what a rounding error changes: who grazes a corner may turn now or a step later."""
    first, *others = (trace(one, steps)[:, :2] for one in data)
    if all(np.allclose(other, first, atol=EQUAL, rtol=0) for other in others):
        return
    rounded = np.max([np.abs(trace(one, steps)[:, :2] - first) for one in wrong_by_rounding(data[0])], axis=0)
    for k, other in enumerate(others, start=1):
        assert np.all(np.abs(other - first) <= EQUAL + 2 * rounded.max(axis=1, keepdims=True)), f"spelling {k}"


def wrong_by_rounding(data: dict[str, Any]) -> list[dict[str, Any]]:
    """The scene with its obstacle moved by a few errors of a coordinate."""
    x, y, turn = data["obstacle"]["state"]
    errors = [(a * size, b * size) for size in (1e-15, 1e-14) for a, b in ((1, 0), (-1, 0), (0, 1), (0, -1))]
    return [{**data, "obstacle": {**data["obstacle"], "state": [x + a, y + b, turn]}} for a, b in errors]


def random_box(rng: np.random.Generator) -> list[dict[str, Any]]:
    return spellings_of_a_box(*rng.uniform(0.5, 3, 2).tolist())


def random_outline(rng: np.random.Generator) -> list[dict[str, Any]]:
    """Spellings of a convex outline; the last one is a fan of triangles."""
    hull: Any = shapely.MultiPoint(rng.uniform(-1.5, 1.5, (8, 2))).convex_hull
    corners = shapely.get_coordinates(hull.exterior)[:-1].tolist()
    middle = np.mean(corners, axis=0).tolist()
    fan = [polygon([middle, a, b]) for a, b in itertools.pairwise([*corners, corners[0]])]
    return [polygon(corners), polygon(corners[2:] + corners[:2]), line(corners), {"name": "compound", "parts": fan}]


@pytest.mark.parametrize("spellings", [random_box, random_outline])
@pytest.mark.parametrize("behavior", BEHAVIORS)
@pytest.mark.parametrize("drive", DRIVES)
@for_all(8, seed=st.integers(0, 2**32 - 1))
def test_every_spelling_gives_the_same_motion(behavior: str, drive: str, spellings: Any, seed: int) -> None:
    assert_equal(random_scenes(behavior, drive, spellings, seed), 60)


def test_a_grazed_corner_is_passed_alike_but_for_rounding() -> None:
    assert_equal(random_scenes("avocado", "diff", random_box, 47773), 60)


def random_scenes(behavior: str, drive: str, spellings: Any, seed: int) -> list[dict[str, Any]]:
    """One wall at a random pose, in all its spellings."""
    rng = np.random.default_rng(seed)
    shapes = spellings(rng)
    pose = [*rng.uniform([6, 9], [8, 11]).tolist(), float(rng.uniform(-math.pi, math.pi))]
    return [scene(behavior, drive, shape, pose) for shape in shapes]


@pytest.mark.parametrize("local", ["dash", *BEHAVIORS])
@pytest.mark.parametrize("start", [0.0, 0.4])
def test_follow_goes_round_a_block_of_a_map_as_round_a_box(local: str, start: float, tmp_path: Path) -> None:
    picture = np.full((400, 400), 255, dtype=np.uint8)  # cells of 5 cm: not the planner's
    picture[172:206, 180:220] = 0  # 2 m by 1.7 m at (10, 10.55); the first row is the top
    boxes = [scene("follow", "diff", shape, [10, 10.55, 0], start) for shape in spellings_of_a_box(2, 1.7)]
    for data in boxes:
        data["robot"]["behavior"]["local"] = local
    assert_equal([*boxes, with_map(boxes[0], picture, tmp_path)], 130)


def test_follow_finds_the_way_that_only_the_cells_of_a_map_show(tmp_path: Path) -> None:
    picture = np.full((600, 600), 255, dtype=np.uint8)  # cells of 3.3 cm
    picture[:, 300:330] = 0
    picture[300:313, 300:330] = 255  # a way of 43 cm through a wall of 1 m; the robot is 40 cm wide
    data = scene("follow", "omni", {"name": "circle", "radius": 1}, [0, 0, 0])
    assert_success(yaml.safe_dump(with_map(data, picture, tmp_path)), seed=0)


@pytest.mark.parametrize("behavior", BEHAVIORS)
@pytest.mark.parametrize("drive", ["diff", "omni"])
@pytest.mark.parametrize("start", [0.0, 0.13])
def test_walls_on_decimal_places_give_the_same_motion_to_the_bit(
    behavior: str, drive: str, start: float, tmp_path: Path
) -> None:
    """Sums such as 10.1 + 0.25 differ in their last bit from one spelling to another, and one bit decides a step."""
    corners = [[-1, -1], [1, -1], [1, -0.6], [-0.6, -0.6], [-0.6, 1], [-1, 1]]
    parts = [([0, -0.8], 2, 0.4), ([-0.8, 0.2], 0.4, 1.6)]
    boxes = [{"name": "rectangle", "length": a, "width": b, "pose": [*at, 0]} for at, a, b in parts]
    shapes = [
        polygon(corners),
        polygon(corners[3:] + corners[:3]),
        line(corners),
        line(corners[::-1]),
        {"name": "compound", "parts": boxes},
    ]
    scenes = [scene(behavior, drive, shape, [10, 10.1, 0], start) for shape in shapes]
    picture = np.full((400, 400), 255, dtype=np.uint8)
    picture[400 - 190 : 400 - 182, 180:220] = 0
    picture[400 - 222 : 400 - 182, 180:188] = 0
    first, *others = (trace(one, 200) for one in [*scenes, with_map(scenes[0], picture, tmp_path)])
    for k, other in enumerate(others, start=1):
        np.testing.assert_array_equal(other, first, err_msg=f"spelling {k}")


@pytest.mark.parametrize("behavior", ["rvo", "sfm", "orca", "avocado"])
@pytest.mark.parametrize("drive", ["diff", "omni"])
@pytest.mark.parametrize(
    ("size", "offset"),
    [
        pytest.param(s, dy, marks=[] if dy == 0.2 else [pytest.mark.slow])
        for s in (0.5, 1, 2, 3)
        for dy in (0, 0.05, 0.2, 0.5, 0.8)
    ],
)
def test_boxes_are_passed(behavior: str, drive: str, size: float, offset: float) -> None:
    for shape in spellings_of_a_box(size, size)[::3]:
        assert_success(yaml.safe_dump(scene(behavior, drive, shape, [10, 10 + offset, 0])), seed=0)


@pytest.mark.parametrize("behavior", ["rvo", "orca", "avocado"])
@pytest.mark.parametrize("turn", [0.0, 0.7, 2.0])
def test_a_turned_world_turns_the_way_past_a_wall(behavior: str, turn: float) -> None:
    """In every direction, with the wall exactly across the way."""
    data = scene(behavior, "diff", {"name": "rectangle", "length": 0.2, "width": 4}, [10, 10, turn])
    way = 5 * np.array([math.cos(turn), math.sin(turn)])
    data["robot"]["state"] = [*(10 - way).tolist(), turn]
    data["robot"]["goal"] = (10 + way).tolist()
    assert irsim.run(text=yaml.safe_dump(data), seed=0).outcome == "success"


@pytest.mark.parametrize("behavior", ["rvo", "orca", "avocado"])
@pytest.mark.parametrize("goal", [0.4, 0.6, 1.0, 2.0])
def test_a_goal_before_a_wall_is_reached(behavior: str, goal: float) -> None:
    data = scene(behavior, "diff", {"name": "rectangle", "length": 2, "width": 6}, [10, 10, 0])
    data["robot"]["goal"] = [9 - goal, 10]
    assert irsim.run(text=yaml.safe_dump(data), seed=0).outcome == "success"


@pytest.mark.parametrize("behavior", ["rvo", "orca"])
@pytest.mark.parametrize("spelling", ["rectangles", "lines", "closed line"])
def test_a_room_is_crossed_past_a_box(behavior: str, spelling: str) -> None:
    ends = [[6, 6], [14, 6], [14, 14], [6, 14], [6, 6]]
    sides = [([10, 5.9], 8.4, 0.2), ([10, 14.1], 8.4, 0.2), ([5.9, 10], 0.2, 8.4), ([14.1, 10], 0.2, 8.4)]
    walls: dict[str, list[dict[str, Any]]] = {
        "rectangles": [
            {"shape": {"name": "rectangle", "length": a, "width": b}, "state": [*at, 0]} for at, a, b in sides
        ],
        "lines": [
            {"shape": {"name": "linestring", "vertices": [a, b]}, "state": [0, 0, 0]}
            for a, b in itertools.pairwise(ends)
        ],
        "closed line": [{"shape": {"name": "linestring", "vertices": ends}, "state": [0, 0, 0]}],
    }
    data = scene(behavior, "diff", {"name": "rectangle", "length": 2, "width": 2}, [10, 10.15, 0])
    data["robot"]["state"], data["robot"]["goal"] = [6.7, 6.7, 0.785], [13.3, 13.3]
    data["obstacle"] = [data["obstacle"], *walls[spelling]]
    assert irsim.run(text=yaml.safe_dump(data), seed=0).outcome == "success"
