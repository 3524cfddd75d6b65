"""The bench: layouts that are valid in every spelling, a judge beside shapely, and kept outcomes that stay the same."""

from __future__ import annotations

import hashlib
import math
import os
import time
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import yaml

import irsim
from tests.parity.avoidance.families import (
    BEHAVIORS,
    CASES,
    CELL_M,
    PEER_BEHAVIORS,
    RADIUS_M,
    SIZE_M,
    Case,
    Group,
    groups,
    layout,
    scenario,
)
from tests.parity.avoidance.judge import Judge, Verdict, at_ends, at_rest, within_steps
from tests.parity.avoidance.results import FOLDER, read
from tests.parity.avoidance.worker import line, write_start

pytestmark = pytest.mark.one_python

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


BAR = [(-0.01, -1.0), (0.01, -1.0), (0.01, 1.0), (-0.01, 1.0)]
FAR = [(9.0, 9.0), (-9.0, 9.0)]


def judged(path: Any, goals: Any = FAR, walls: Any = (), *, loop: bool = False) -> Verdict:
    """The verdict about robots with a radius of 0.2 m."""
    judge = Judge(goals, list(walls), radius=0.2, threshold=0.2, dt=0.1, loop=loop)
    verdict = judge.verdict(path)
    assert judge.ended(path) == (verdict.outcome == "c" or (verdict.outcome == "a" and not loop))
    return verdict


def test_those_that_jump_through_each_other_touch_between_steps() -> None:
    path = [[(-0.5, 0.1), (0.5, -0.1)], [(0.5, 0.1), (-0.5, -0.1)]]
    verdict = judged(path, FAR, [])
    assert (verdict.outcome, verdict.between) == ("t", 1)
    assert verdict.depth_m == pytest.approx(0.2)  # they pass at 0.2 m, their radii are 0.4 m together
    assert verdict.touched
    assert not verdict.success


def test_an_overlap_at_the_end_of_a_step_ends_the_episode() -> None:
    path = [[(0.0, 0.0), (1.0, 0.0)], [(0.0, 0.0), (0.5, 0.0)], [(0.0, 0.0), (0.3, 0.0)], [(9.0, 9.0), (-9.0, 9.0)]]
    verdict = judged(path, FAR, [])
    assert (verdict.outcome, verdict.seconds, verdict.between) == ("c", 0.2, 0)
    assert verdict.depth_m == pytest.approx(0.1)


@pytest.mark.parametrize(("gap", "outcome"), [(-1e-7, "t"), (-1e-5, "c"), (1e-7, "t")])
def test_rounding_is_no_contact(gap: float, outcome: str) -> None:
    path = [[(0.0, 0.0), (1.0, 0.0)], [(0.0, 0.0), (0.4 + gap, 0.0)]]
    assert judged(path, FAR, []).outcome == outcome


def test_all_have_arrived_once_each_is_near_its_goal() -> None:
    path = [[(0.0, 0.0), (3.0, 0.0)], [(0.9, 0.0), (3.0, 0.0)], [(0.9, 0.0), (2.1, 0.0)], [(0.9, 0.0), (1.0, 0.0)]]
    verdict = judged(path, [(1.0, 0.0), (2.0, 0.0)])
    assert (verdict.outcome, verdict.seconds, verdict.success) == ("a", 0.2, True)


def test_an_arrival_after_a_pass_is_no_success() -> None:
    path = [[(-0.5, 0.1), (0.5, -0.1)], [(0.5, 0.1), (-0.5, -0.1)]]
    verdict = judged(path, [(0.5, 0.1), (-0.5, -0.1)])
    assert (verdict.outcome, verdict.success) == ("a", False)


def test_a_thin_wall_between_two_poses_is_a_contact_between_steps() -> None:
    verdict = judged([[(-0.3, 0.0)], [(0.3, 0.0)]], FAR[:1], [BAR])
    assert (verdict.outcome, verdict.between > 0) == ("t", True)


def test_a_corner_is_rounded_without_a_contact() -> None:
    corner = np.array(BAR[2])
    beside = [[corner + 0.2001 * np.array([np.cos(a), np.sin(a)])] for a in np.linspace(0.0, np.pi / 2, 200)]
    verdict = judged(beside, FAR[:1], [BAR])
    assert (verdict.outcome, verdict.between) == ("t", 0)


def test_back_and_forth_needs_a_crossing_and_no_standstill() -> None:
    there = [[(0.1 * k, 0.0)] for k in range(11)]
    back = there[::-1]
    assert judged([*there, *back], [(1.0, 0.0)], [], loop=True).outcome == "a"
    assert judged(there[:5], [(1.0, 0.0)], [], loop=True).outcome == "t"
    stuck = [*there, *([[(1.0, 0.0)]] * 60)]
    assert at_rest(stuck, 0.1)
    assert judged(stuck, [(1.0, 0.0)], [], loop=True).outcome == "t"


def test_distances_within_steps_are_those_of_shapely() -> None:
    draw = np.random.default_rng(5)
    for _ in range(100):
        path = draw.uniform(-2, 2, (2, 2, 2))
        ring = shapely.convex_hull(shapely.MultiPoint(draw.uniform(-1, 1, (6, 2))))
        corners = np.asarray(ring.exterior.coords)[:-1]
        ends, within = at_ends(path, [corners], 0.2), within_steps(path, [corners], 0.2)
        edges = shapely.LineString([*corners, corners[0]])
        for robot in range(2):
            wanted = shapely.LineString(path[:, robot]).distance(edges) - 0.2
            columns = slice(1 + robot * len(corners), 1 + (robot + 1) * len(corners))
            assert within[0, columns].min() == pytest.approx(wanted, abs=1e-12)
            for k in range(2):
                assert ends[k, columns].min() == pytest.approx(shapely.Point(path[k, robot]).distance(edges) - 0.2)
        apart = shapely.LineString(path[:, 0] - path[:, 1])
        assert within[0, 0] == pytest.approx(apart.distance(shapely.Point(0, 0)) - 0.4, abs=1e-12)


KEPT = read([FOLDER / "ours.csv"])
PARTS = 10


def part(group: Group) -> int:
    """Which tenth a group belongs to; names decide, so that each tenth has some of everything."""
    return zlib.crc32(" ".join(group.key).encode()) % PARTS


def different(chosen: list[Group], folder: Path) -> list[str]:
    """Groups whose line differs from the kept one."""
    return [" ".join(group.key) for group in chosen if tuple(line(group, folder)) != KEPT[group.key].row]


def test_every_group_is_kept_with_all_its_starts() -> None:
    assert {key: len(kept.letters) for key, kept in KEPT.items()} == {g.key: len(g.starts) for g in groups(BEHAVIORS)}
    known = {group.key: len(group.starts) for group in groups(PEER_BEHAVIORS)}
    for key, kept in read([FOLDER / "peer.csv"]).items():
        assert len(kept.letters) == known[key]


def test_some_groups_are_the_kept_ones(tmp_path: Path) -> None:
    chosen = groups(BEHAVIORS)[::3]
    short = [group for group in chosen if group.dt == 0.2 and part(group) == 0 and group.case.name != "30"]
    assert different(short, tmp_path) == []


@pytest.mark.nightly
@pytest.mark.slow(20)
@pytest.mark.parametrize("behavior", BEHAVIORS)
def test_a_tenth_is_the_kept_one(behavior: str, tmp_path: Path) -> None:
    """The first tenth; each night another one (``nox -s nightly``)."""
    today = int(time.time() // 86400) % PARTS if os.environ.get("IRSIM_NIGHTLY") else 0
    assert different([group for group in groups((behavior,)) if part(group) == today], tmp_path) == []
