"""Findings about ways: too little time, dead ends, walls, and how long it takes to find it."""

from __future__ import annotations

import re
import time
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.env import Env
from irsim.scenario.read import read
from irsim.validation.feasibility.check import feasibility_findings
from tests.scenario.test_checks_single import named
from tests.validation.test_findings import DISC, ROBOT, ROOT, arrives, box, codes, disc, door, findings, one, scenario


def line(*vertices: tuple[float, float]) -> dict[str, Any]:
    return {"shape": {"name": "linestring", "vertices": [list(corner) for corner in vertices]}, "state": [0, 0, 0]}


POCKET = [[3, 2], [6, 2], [6, 8], [3, 8], [3, 7.8], [5.8, 7.8], [5.8, 2.2], [3, 2.2]]
DASH = {**ROBOT, "behavior": {"name": "dash"}}
FOLLOW = {**ROBOT, "behavior": {"name": "follow"}}
TRAP = line((3, 1.2), (8, 1.2), (8, 8.8), (3, 8.8))
WALL = box(0.2, 4, 6, 5)


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (scenario(ROBOT, time_limit=12), []),
        (scenario({**ROBOT, "behavior": {"name": "rvo", "loop": True}}, time_limit=5), []),
        (scenario(FOLLOW, box(0.2, 8.6, 6, 4.3), time_limit=9), ["time-too-short"]),  # the way round is longer
        (scenario(FOLLOW, box(0.2, 8.6, 6, 4.3), time_limit=14), []),
        (scenario(FOLLOW, time_limit=9), []),
        (scenario(DASH, disc(0.5, 6, 5)), ["dash-into-obstacle"]),
        (scenario(DASH, disc(0.5, 6, 7)), []),
        (scenario(ROBOT, disc(0.5, 6, 5)), []),
        (scenario({**ROBOT, "state": [5, 5, 0]}, TRAP), ["needs-planning"]),
        (scenario({**FOLLOW, "state": [5, 5, 0]}, TRAP), []),
        # Sliding towards the goal, the body passes an end of a hook that is nearer than its radius.
        (scenario({**ROBOT, "state": [3.5, 5, 0]}, line((2, 8), (2, 2), (6, 2), (6, 5.25))), []),
        (scenario({**ROBOT, "state": [3.5, 5, 0]}, line((2, 8), (2, 2), (6, 2), (6, 6))), ["needs-planning"]),
    ],
)
def test_what_is_reported_of_a_way(data: dict[str, Any], expected: list[str]) -> None:
    assert codes(data) == expected


def test_too_little_time() -> None:
    item = one(scenario(ROBOT, time_limit=5), "time-too-short")
    assert (item.severity, item.path) == ("warning", ("world", "time_limit"))
    assert one(scenario(ROBOT, time_limit=8.2), "time-too-short").severity == "hint"


def test_one_time_limit_is_long_enough_for_all_robots() -> None:
    late = {**ROBOT, "name": "late", "state": [2, 3, 0], "goal": [4, 3], "start_time": 30}
    data = scenario({**ROBOT, "start_time": 6}, time_limit=10)
    data["robot"] += [late, {**ROBOT, "name": "ap", "state": [2, 7, 0], "goal": [10, 7], "appear_time": 12}]
    item = one(data, "time-too-short")
    assert "'late' needs at least 31.9 s" in item.message
    assert "time_limit is 10 s; 2 more robots need more than that" in item.message
    assert str(item.fix).startswith("time_limit: 36,")
    data["world"]["time_limit"] = 36
    assert codes(data) == []


@pytest.mark.parametrize("behavior", ["dash", "rvo", "orca", "sfm"])
def test_nobody_hurries_backwards(behavior: str) -> None:
    """The limit backwards stays at 1 m/s by default, and helps none of the behaviors forwards."""
    robot = {**ROBOT, "behavior": {"name": behavior}, "vel_max": [0.1, 1]}
    item = one(scenario(robot, time_limit=20), "time-too-short")
    assert (item.severity, "at 0.1 m/s" in item.message) == ("warning", True)
    assert "time-too-short" not in codes(scenario(robot, time_limit=200))
    env = Env(read(scenario(robot, time_limit=20)).scenario, headless=True, seed=0)
    env.rollout(200)
    assert not env.robot.arrive
    assert 1.5 < env.robot.position[0, 0] - 2 <= 2.01
    env.end(ending_time=0.0)


def test_wanderers_whose_goals_lie_in_walls() -> None:
    block = box(6, 6, 8, 5)
    wander = {**DISC, "state": [2, 5, 0], "behavior": {"name": "rvo", "wander": True}}
    item = one(scenario(wander, block), "wander-blocked")
    share = int(re.findall(r"about (\d+)%", item.message)[0])
    assert share == pytest.approx(100 * 6.4 * 6.4 / 120, abs=8)
    inside = {**wander, "behavior": {"name": "rvo", "wander": True, "range_low": [1, 1], "range_high": [4, 9]}}
    assert codes(scenario(inside, block)) == []


def test_one_finding_for_many_robots() -> None:
    data = door(0.5, boundary="walls")
    states = [[1 + 0.9 * (k % 4), 1 + 0.9 * (k // 4), 0] for k in range(6)]
    data["robot"] = [{**DISC, "number": 6, "state": states, "goal": [[11 - s[0] + 1, s[1]] for s in states]}]
    assert "likewise 5 more" in one(data, "goal-unreachable").message


def test_the_same_findings_every_time() -> None:
    path = ROOT / "templates/random-polygons/scenario.yaml"
    assert findings(path) == findings(path)


PLACES = np.random.default_rng(5)


def places(number: int, size: float) -> list[list[float]]:
    return [[float(x), float(y), 0.0] for x, y in PLACES.uniform(1, size - 1, (number, 2))]


def serpentine() -> Any:
    cells = np.zeros((4000, 4000), dtype=np.uint8)
    for k in range(60):
        cells[k * 66 : k * 66 + 4, (200 if k % 2 else 0) : (4000 if k % 2 else 3800)] = 100
    return cells


def large(robot: dict[str, Any], size: float, *obstacles: dict[str, Any], **world: Any) -> dict[str, Any]:
    return scenario({**DISC, **robot}, *obstacles, width=size, height=size, **world)


ACROSS = {"state": [1, 199, 0], "goal": [199, 100]}
RANDOM = {"name": "random"}
LARGE = {
    "5000 obstacles, 100 robots": lambda: large(
        {"number": 100, "state": places(100, 200), "goal": [p[:2] for p in places(100, 200)]}, 200,
        {"number": 5000, "state": places(5000, 200), "shape": {"name": "circle"}},
    ),
    "5000 robots at random": lambda: large({"number": 5000, "distribution": RANDOM}, 400),
    "1000 robots in a crowd": lambda: large({"number": 1000, "distribution": {**RANDOM, "min_distance": 1.11}}, 50),
    "16 million cells": lambda: large(ACROSS, 200, obstacle_map=serpentine()),
    "16 million random cells": lambda: large(
        ACROSS, 200, obstacle_map=np.random.default_rng(1).integers(0, 53, (4000, 4000), dtype=np.uint8)
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", LARGE)
def test_it_stays_quick(name: str) -> None:
    """0.3 s more than reading alone; ten times that here, for slow machines with other work."""
    data = LARGE[name]()
    before = time.process_time()
    read(data, strict=True)
    middle = time.process_time()
    read(data, strict=True, feasibility=feasibility_findings)
    assert time.process_time() - middle < (middle - before) + 3.0


@pytest.mark.parametrize("behavior", ["rvo", "sfm", "orca"])
def test_a_pocket_stops_who_plans_no_way_and_a_single_wall_does_not(behavior: str) -> None:
    """Where the goal lies straight behind them: the engine says the same."""
    robot = {**ROBOT, "state": [3.5, 5, 0], "behavior": {"name": behavior}}
    pocket = {"shape": {"name": "polygon", "vertices": POCKET}, "state": [0, 0, 0]}
    for thing, stuck in ((pocket, True), (WALL, False)):
        data = scenario(robot, thing)
        told = [d for d in findings(data) if d.code == "needs-planning"]
        assert bool(told) is stuck
        assert not told or "(5.80, 5.00)" in told[0].message
        assert arrives(data) != stuck


def test_before_a_wall_dash_is_told_to_follow() -> None:
    for thing in (WALL, disc(0.3, 6, 5)):
        assert "get around single obstacles" in str(one(scenario(DASH, thing), "dash-into-obstacle").fix)


def test_speeding_up_takes_time() -> None:
    robot = {**DASH, "acce": [0.05, 1]}
    item = one(scenario(robot, time_limit=12), "time-too-short")
    assert "needs at least 17.8 s" in item.message
    assert "larger acce" in str(item.fix)
    assert codes(scenario(robot, time_limit=60)) == []
    soon = {**robot, "acce": [0.25, 1]}  # 4 s and 2 m until full speed, then 5.9 m at 1 m/s
    assert "needs at least 9.9 s" in one(scenario(soon, time_limit=8), "time-too-short").message


def test_walkers_behind_a_wall_are_a_hint() -> None:
    walker = {"kinematics": {"name": "omni"}, "shape": {"name": "circle", "radius": 0.3}, "behavior": {"name": "sfm"}}
    data = scenario(ROBOT, {**walker, "state": [3, 8, 0], "goal": [3, 1]}, box(12, 0.2, 6, 3), boundary="walls")
    item = one(data, "goal-unreachable")
    assert (item.severity, item.path) == ("hint", ("obstacle", 0, "goal"))


def test_in_random_scenes_no_single_place_is_named() -> None:
    boxes = {"number": 30, "shape": {"name": "circle", "radius": 0.4}, "distribution": {"name": "random"}}
    fix = str(one(scenario(ROBOT, boxes), "goal-blocked").fix)
    assert "'range_low' and 'range_high'" in fix
    assert "is free" not in fix


HALL = """
world: {width: 20, height: 10, boundary: walls}
robot: {name: car, kinematics: {name: acker, wheelbase: 1.0}, shape: {name: rectangle, length: 1.6, width: 0.8},
  state: [2, 5, 0], goal: %s, goal_threshold: 0.3, vel_max: [1.5, 0.6], vel_min: [-1, -0.6], behavior: %s}
"""


@pytest.mark.parametrize(
    ("goal", "behavior", "outcome", "advised"),
    [
        ("[18, 5]", "{name: orca}", "timeout", True),
        ("[18, 5]", "{name: follow, local: {name: orca}}", "success", False),
        ("[15, 5]", "{name: orca}", "success", False),
    ],
)
def test_a_car_that_plans_nothing_near_walls_should_follow(
    goal: str, behavior: str, outcome: str, advised: bool
) -> None:
    text = HALL % (goal, behavior)
    assert [f.fix for f in named("needs-planning", text)] == ["behavior: {name: follow, local: {name: orca}}"] * advised
    result = irsim.run(text=text, seed=1)
    assert result.outcome == outcome
    assert ("use behavior: {name: follow, local: {name: orca}}" in str(result.reason)) is advised


def test_a_car_before_an_obstacle_should_follow() -> None:
    shelf = "obstacle: {shape: {name: rectangle, length: 0.3, width: 6}, state: [10, 2.2, 0]}\n"
    [finding] = named("needs-planning", HALL % ("[15, 5]", "{name: rvo}") + shelf)
    assert "cannot turn on the spot" in finding.message
    assert finding.fix == "behavior: {name: follow, local: {name: rvo}}"


@pytest.mark.parametrize("behavior", ["rvo", "orca"])
def test_a_robot_that_stands_in_a_pocket_says_what_to_change(behavior: str) -> None:
    text = f"""
world: {{width: 12, height: 8}}
robot: {{name: r, kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.3}}, state: [3.5, 4, 0], goal: [11, 4],
  behavior: {{name: {behavior}}}}}
obstacle: {{name: box, shape: {{name: polygon, vertices: {POCKET}}}, state: [0, -1, 0]}}
"""
    advice = f"{behavior} plans no path: use behavior: {{name: follow, local: {{name: {behavior}}}}}"
    result = irsim.run(text=text, seed=1)
    assert result.outcome == "timeout"
    assert "'box' is 0." in str(result.reason)
    assert advice in str(result.reason)
    tried = irsim.validate(text=text, simulate=True).dry_run
    assert tried is not None
    assert advice in tried.summary
    mended = text.replace(f"{{name: {behavior}}}", f"{{name: follow, local: {{name: {behavior}}}}}")
    assert irsim.run(text=mended, seed=1).outcome == "success"


def _wall(*gap: float) -> list[dict[str, Any]]:
    """A wall across the world of 12 x 10 m at x = 6, with a gap between two heights."""
    low, high = gap
    return [box(0.2, low, 6, low / 2), box(0.2, 10 - high, 6, (10 + high) / 2)]


@pytest.mark.parametrize("local", ["orca", "rvo", "sfm"])
def test_robots_that_share_a_door_are_told_which_behaviors_jam(local: str) -> None:
    behavior = {"name": "follow", "local": local}
    robots = [{**ROBOT, "state": [2, y, 0], "goal": [10, y], "behavior": behavior} for y in (4, 5, 6)]
    data = scenario(robots[0], *_wall(4.5, 5.5))
    data["robot"] = robots
    jams = [item for item in findings(data) if item.code == "door-jam"]
    assert len(jams) == (local != "orca")
    for item in jams:
        assert "2 other robots drive through a gap of 1 m at (6" in item.message
        assert "local: {name: orca}" in str(item.fix)
    data["obstacle"] = _wall(3.5, 6.5)  # two have room side by side
    assert "door-jam" not in codes(data)
    data["robot"], data["obstacle"] = robots[:1], _wall(4.5, 5.5)
    assert "door-jam" not in codes(data)


@pytest.mark.parametrize(
    ("key", "closed", "words", "wider"),
    [
        ("within", {"rectangle": [0, 4, 12, 6]}, "stays in 'within'", {"rectangle": [0, 2, 12, 8]}),
        ("avoid", ["closed", "open"], "keeps out of 'closed', 'open'", ["closed"]),
    ],
)
def test_a_region_or_zone_that_leaves_no_path_is_reported(key: str, closed: Any, words: str, wider: Any) -> None:
    zones = [{"name": "closed", "rectangle": [5, 0, 7, 4]}, {"name": "open", "rectangle": [5, 6, 7, 10]}]

    def limited(limit: Any) -> dict[str, Any]:
        robot = {**ROBOT, "behavior": {"name": "follow", key: limit}}
        return scenario(robot, box(1, 2, 6, 5), boundary="walls", zones=zones)

    item = one(limited(closed), "goal-unreachable")
    assert item.severity == "warning"
    assert words in item.message
    assert "goal-unreachable" not in codes(limited(wider))
