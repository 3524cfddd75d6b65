"""The layouts are valid, the same in every spelling, and the layouts of the references."""

from __future__ import annotations

import hashlib
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import yaml

import irsim
from tests.avoidance.families import CASES, CELL_M, RADIUS_M, SIZE_M, Case, Group, groups, layout, scenario
from tests.avoidance.judge import at_ends
from tests.avoidance.worker import write_start

FIXED = "d1c4a84c8e3fef085d15c97fc832347f7f05223625fac33ead0911140538d527"


def group(case: Case, spelling: str) -> Group:
    return Group("rvo", "diff", 0.1, case, spelling)


def cells(env: Any) -> list[tuple[float, float, float, float]]:
    """Occupied cells of the map of a world."""
    occupied = np.argwhere(np.asarray(env.get_map(resolution=0).grid) > 50) * CELL_M
    return [(x, y, x + CELL_M, y + CELL_M) for x, y in occupied]


def test_the_layouts_are_those_of_the_references() -> None:
    """Who changes a layout, a seed or a number of starts has to run both simulators again."""
    known = hashlib.sha256()
    for one in groups():
        known.update(f"{one.key} {one.starts}".encode())
    for case in CASES:
        for start in case.starts(0.1, case.spellings[0]):
            scene = layout(case, start)
            places = [
                value for robot in scene.robots for value in (*robot.start, *robot.goal, robot.heading, robot.speed)
            ]
            corners = [value for wall in scene.walls for corner in wall.outline() for value in corner]
            known.update(f"{[round(value, 6) + 0.0 for value in places + corners]}".encode())
    assert known.hexdigest() == FIXED


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.family}-{case.name}")
def test_nobody_touches_anything_at_start_or_goal(case: Case) -> None:
    for start in case.starts(0.1, case.spellings[0]):
        scene = layout(case, start)
        walls = [wall.outline() for wall in scene.walls]
        for places in ([r.start for r in scene.robots], [r.goal for r in scene.robots]):
            ends = at_ends(np.array([places]), walls, RADIUS_M)
            assert ends.min(initial=1.0) > 0.05
            assert all(RADIUS_M < value < SIZE_M - RADIUS_M for place in places for value in place)
            assert not any(shapely.Polygon(ring).contains(shapely.Point(at)) for ring in walls for at in places)
        assert all(0 <= math.dist(r.start, r.goal) / r.speed < case.limit_s for r in scene.robots)


@pytest.mark.parametrize("case", [case for case in CASES if len(case.spellings) == 4], ids=lambda case: case.name)
def test_a_wall_is_the_same_in_every_spelling(case: Case, tmp_path: Path) -> None:
    wanted = shapely.union_all([shapely.Polygon(wall.outline()) for wall in layout(case, 0).walls])
    for spelling in case.spellings:
        env = irsim.make(str(write_start(group(case, spelling), 0, tmp_path)), display=False)
        bodies = [thing.geometry for thing in env.obstacle_list]
        if spelling == "map":
            built = shapely.union_all([shapely.box(*cell) for cell in cells(env)])
        elif spelling == "line":
            built = shapely.union_all([shapely.Polygon(body.coords) for body in bodies])
        else:
            built = shapely.union_all(bodies)
        env.end(0)
        assert built.symmetric_difference(wanted).area < 1e-9, spelling


def test_an_exact_circle_is_the_distribution_of_that_name(tmp_path: Path) -> None:
    for case in CASES:
        if case.ring:
            env = irsim.make(str(write_start(group(case, ""), 0, tmp_path)), display=False)
            robots = layout(case, 0).robots
            for robot, placed in zip(robots, env.robot_list, strict=True):
                assert placed.state[:2, 0] == pytest.approx(robot.start)
                assert placed.goal[:2, 0] == pytest.approx(robot.goal)
            env.end(0)


def test_spelling_behavior_drive_and_step_do_not_change_a_start() -> None:
    case = next(case for case in CASES if case.family == "box")
    states = {
        yaml.safe_dump(scenario(one, 3, "map.png")["robot"][0]["state"])
        for one in groups() if one.case is case
    }  # fmt: skip
    assert len(states) == 1
