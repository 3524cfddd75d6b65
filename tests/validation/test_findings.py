"""Findings that need the world: each where it should be, with the right numbers, and no finding where all is well."""

from __future__ import annotations

import copy
import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import irsim
from irsim.common.text import metres
from irsim.diagnostics.diagnostic import Diagnostic, format_path
from irsim.env import Env
from irsim.scenario.read import read
from irsim.validation.feasibility.check import feasibility_findings

ROOT = Path(__file__).parents[2]
SCENARIOS = sorted(ROOT.glob("tests/parity/scenarios/*.yaml"))
SHOWN = {
    "acker-goal-behind": {"turning-circle"},
    "arrive-at-start": {"goal-reached"},
    "collide-initial": {"initial-overlap"},
    "collide-inside": {"initial-overlap"},
    "collide-thin": {"jumps-through"},
    "map-offset": {"goal-overshoot"},
    "world-big-numbers": {"goal-overshoot"},
    "lidar-full-circle": {"angle-over-full-turn"},
    "lidar-scan-header": {"angle-over-full-turn"},
    "limits-zero": {"no-speed", "no-turning"},
    "make-overlap": {"initial-overlap"},
    "make-waypoint-at-start": {"goal-reached"},
    "reset-waypoint-at-start": {"goal-reached"},
    "waypoints-two-levels": {"goal-levels"},
    "world-static": {"static-behavior"},
}
"""Scenarios that are there to show one of these."""

DISC = {"kinematics": {"name": "diff"}, "shape": {"name": "circle", "radius": 0.3}, "behavior": {"name": "rvo"}}
ROBOT = {**DISC, "state": [2, 5, 0], "goal": [10, 5]}


def findings(data: Any) -> list[Diagnostic]:
    return list(read(data, strict=True, feasibility=feasibility_findings).diagnostics)


def codes(data: Any) -> list[str]:
    return [d.code for d in findings(data)]


def one(data: Any, code: str) -> Diagnostic:
    matching = [d for d in findings(data) if d.code == code]
    assert len(matching) == 1, findings(data)
    assert matching[0].fix
    return matching[0]


def scenario(robot: dict[str, Any], *obstacles: dict[str, Any], **world: Any) -> dict[str, Any]:
    data = {"world": {"width": 12, "height": 10, **world}, "robot": [robot], "obstacle": list(obstacles)}
    return copy.deepcopy(data)


def door(width: float, robot: dict[str, Any] = ROBOT, **world: Any) -> dict[str, Any]:
    """A wall across the world at x = 6 with a door in the middle."""
    part = (10 - width) / 2
    shape = {"name": "rectangle", "length": 0.2, "width": part}
    walls = {"number": 2, "shape": shape, "state": [[6, part / 2, 0], [6, 10 - part / 2, 0]]}
    return scenario(robot, walls, **world)


def box(length: float, width: float, *state: float) -> dict[str, Any]:
    return {"shape": {"name": "rectangle", "length": length, "width": width}, "state": [*state, 0]}


def disc(radius: float, *state: float) -> dict[str, Any]:
    return {"shape": {"name": "circle", "radius": radius}, "state": [*state, 0]}


def arrives(data: Any) -> bool:
    """Whether the robot gets there within 40 s."""
    env = Env(read(data).scenario, headless=True, seed=0)
    env.rollout(400)
    return bool(env.robot.arrive)


def places_all(data: Any, seed: int | None = None) -> bool:
    """Whether all objects find a place."""
    try:
        Env(read(data).scenario, headless=True, seed=seed)
    except irsim.ScenarioError:
        return False
    return True


def free_place(item: Diagnostic) -> list[float]:
    """Where the fix says that there is room."""
    return list(map(float, re.findall(r"\((-?[\d.]+), (-?[\d.]+)\) is free", str(item.fix))[0]))


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_no_false_alarms(path: Path) -> None:
    alarms = {d.code for d in findings(path) if d.severity != "hint"}
    assert alarms == SHOWN.get(path.stem, set())


@pytest.mark.parametrize("width", [0.3, 0.45, 0.55, 0.59])
def test_a_door_too_narrow_is_measured(width: float) -> None:
    item = one(door(width, boundary="walls"), "goal-unreachable")
    assert (item.severity, item.path) == ("warning", ("robot", 0, "goal"))
    gap, x, y, need = map(float, re.findall(r"\d+\.?\d*(?= m| at|,|\))", item.message.split("gap of")[1])[:4])
    assert gap == pytest.approx(width, abs=0.008)
    assert (x, y) == pytest.approx((6, 5), abs=0.2)
    assert need == 0.6


@pytest.mark.parametrize(("width", "hint"), [(0.62, True), (0.7, True), (0.8, False), (1.5, False)])
def test_a_door_wide_enough(width: float, hint: bool) -> None:
    data = door(width)
    assert codes(data) == (["narrow-passage"] if hint else [])
    if hint:
        assert float(re.findall(r"gap of ([\d.]+) m", findings(data)[0].message)[0]) == pytest.approx(width, abs=0.008)


def test_what_is_unreachable_is_not_reached_and_the_other_is() -> None:
    """The planner of the engine agrees on both sides of the limit."""
    for width, reached in ((0.55, False), (0.75, True)):
        data = door(width, boundary="walls")
        data["robot"][0]["behavior"] = {"name": "follow"}
        assert ("goal-unreachable" in codes(data)) is not reached
        assert arrives(data) is reached


@pytest.mark.parametrize("radius", [0.1, 0.3, 0.6])
def test_a_place_that_can_be_reached_is_offered(radius: float) -> None:
    data = door(radius, boundary="walls")
    data["robot"][0]["shape"] = {"name": "circle", "radius": radius}
    fix = one(data, "goal-unreachable").fix or ""
    place = list(map(float, re.findall(r"get to \(([\d.]+), ([\d.]+)\)", fix)[0]))
    assert place[0] < 6  # this side of the door
    data["robot"][0]["goal"] = place
    assert codes(data) == []


CAR = {**ROBOT, "shape": {"name": "rectangle", "length": 1.0, "width": 0.5}}
RING = {"shape": {"name": "linestring", "vertices": [[8, 3], [11.5, 3], [11.5, 7], [8, 7], [8, 3]]}, "state": [0, 0, 0]}
BESIDE = box(1, 2, 10.65, 5)  # nearer to the goal than the radius of the robot


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (scenario(ROBOT, RING), "warning goal-unreachable: obstacles separate them completely"),
        (door(0.0), "warning goal-unreachable: outside the world"),
        (door(0.0, boundary="walls"), "warning goal-unreachable: obstacles separate them completely"),
        (door(0.0, collision_mode="unobstructed"), ""),
        (scenario(ROBOT, {**box(0.2, 10, 6, 5), "unobstructed": True}), ""),
        (door(0.4, robot=CAR), "warning goal-unreachable: gap of 0.4 m"),
        (door(0.55, robot=CAR), "hint narrow-passage: gap of 0.55 m"),
        (door(1.0, robot=CAR), ""),
        # A gap that is a little too narrow on a widest way does not hide a longer way.
        (scenario(ROBOT, box(0.2, 4.0, 6, 2.0), box(0.2, 3.0, 6, 6.09), box(0.2, 1.5, 6, 9.25)), ""),
        (scenario({**ROBOT, "goal": [14, 5]}, boundary="walls"), "warning goal-unreachable: outside the walls"),
        (scenario({**ROBOT, "goal": [14, 5]}), ""),
        (scenario({**ROBOT, "goal": [14, 5], "goal_threshold": 3}, boundary="walls"), ""),
        (scenario(ROBOT, BESIDE), "warning goal-blocked: closer than"),
        (scenario({**ROBOT, "goal_threshold": 0.2}, BESIDE), ""),
        (scenario(ROBOT, {**DISC, "state": [6, 3, 0], "goal": [6, 8]}, disc(1, 6, 8)),
            "hint goal-blocked: obstacle[0].goal"),
    ],
)  # fmt: skip
def test_whether_a_goal_can_be_reached(data: dict[str, Any], expected: str) -> None:
    shown = [d for d in findings(data) if d.code in ("goal-unreachable", "narrow-passage", "goal-blocked")]
    finding, _, words = expected.partition(": ")
    assert [f"{d.severity} {d.code}" for d in shown] == ([finding] if expected else [])
    assert all(words in f"{format_path(d.path)} {d.message}" for d in shown)


def test_a_generated_map_has_another_fix() -> None:
    data = scenario({**ROBOT, "state": [2, 2, 0], "goal": [23, 23]}, width=25, height=25)
    data["world"]["obstacle_map"] = {"name": "perlin", "resolution": 0.2, "fill": 0.25, "seed": 31}
    fix = one(data, "goal-unreachable").fix or ""
    assert all(words in fix for words in ("'seed'", "'fill'", "get to ("))


@pytest.mark.parametrize(
    ("obstacle", "words"), [(disc(1, 10.3, 5), "inside 'obstacle_1'"), (box(0.1, 2, 10.2, 5), "closer than")]
)
def test_goals_without_room(obstacle: dict[str, Any], words: str) -> None:
    data = scenario(ROBOT, obstacle)
    item = one(data, "goal-blocked")
    assert words in item.message
    data["robot"][0]["goal"] = free_place(item)
    assert codes(data) == []


def test_goals_by_the_wall_of_the_world() -> None:
    robot = {key: value for key, value in ROBOT.items() if key != "goal"}
    data = scenario({**robot, "waypoints": [[6, 5], [11.9, 5]]}, boundary="walls")
    item = one(data, "goal-blocked")
    assert "waypoint 2" in item.message
    assert item.path == ("robot", 0, "waypoints", 1)
    data["robot"][0]["waypoints"][1] = [11.65, 5]
    assert codes(data) == []


def test_the_waypoint_is_told_with_its_line() -> None:
    text = """\
world: {width: 12, height: 10}
robot:
  - kinematics: {name: diff}
    shape: {name: circle, radius: 0.2}
    state: [1, 1, 0]
    behavior: {name: dash}
    waypoints:
      - [3, 1]
      - [3, 8]
      - [7, 7]
obstacle:
  - {shape: {name: circle, radius: 1}, state: [7, 7]}
"""
    item = one(text, "goal-blocked")
    assert (item.path, item.line) == (("robot", 0, "waypoints", 2), 10)
    item = one(text.replace("[3, 8]", "[11, 9.5]").replace("[7, 7]\nob", "[6, 4.5]\nob"), "dash-into-obstacle")
    assert (item.path, item.line) == (("robot", 0, "waypoints", 2), 10)
    outside = one(text.replace("[3, 8]", "[3, 18]").replace("[7, 7]\nob", "[3, 1]\nob"), "outside-world")
    assert (outside.path, outside.line) == (("robot", 0, "waypoints", 1), 9)


def test_overlaps_say_how_deep_and_where_to() -> None:
    data = {"robot": [{**DISC, "state": [2, 2, 0], "goal": [9, 9]}, {**DISC, "state": [2.4, 2, 0], "goal": [9, 2]}]}
    item = one(data, "initial-overlap")
    assert all(words in item.message for words in ("0.2 m deep", "'robot_0'", "'robot_1'"))
    place = free_place(item)
    assert math.dist(place, [2, 2]) < 0.5
    data["robot"][0]["state"] = [*place, 0]
    assert codes(data) == []


@pytest.mark.parametrize("shape", [{"name": "circle", "radius": 0.3}, {"name": "rectangle", "length": 2, "width": 0.4}])
def test_the_check_and_the_run_measure_one_depth(shape: dict[str, Any], tmp_path: Path) -> None:
    cells = np.full((40, 80), 255, np.uint8)
    cells[10:30, 20:50] = 0  # x 2..5 m, y 1..3 m are occupied, and so is all beyond x = 6 m
    cells[:, 60:] = 0
    Image.fromarray(cells).save(tmp_path / "map.png")
    file = tmp_path / "world.yaml"
    file.write_text(f"""\
world: {{width: 8, height: 4, obstacle_map: map.png}}
robot: {{kinematics: {{name: diff}}, shape: {json.dumps(shape)}, state: [7, 2.5, 0], behavior: {{name: dash}}}}
""")
    run = irsim.run(file, steps=1)
    [message] = [item.message for item in run.warnings if item.code == "initial-overlap"]
    assert run.robots[0].min_clearance is not None
    assert f"the map, {metres(-run.robots[0].min_clearance)} deep" in message


def test_outlines_that_cross_do_not_merely_touch() -> None:
    bar = {"kinematics": {"name": "diff"}, "shape": {"name": "rectangle", "length": 4, "width": 0.2}, "goal": [9, 9]}
    message = one({"robot": [{**bar, "state": [5, 5, 0]}, {**bar, "state": [5, 5, 1.57]}]}, "initial-overlap").message
    assert message.endswith("in collision with 'robot_1'")
    beside = {"robot": [{**bar, "state": [5, 5, 0]}, {**bar, "state": [6, 5.19995, 0]}]}
    assert one(beside, "initial-overlap").message.endswith(": they touch")


def test_a_start_in_the_map() -> None:
    robot = {**DISC, "state": [0.05, 0.05, 0], "goal": [18, 13], "behavior": {"name": "follow"}}
    data = {"world": {"width": 20, "height": 15, "obstacle_map": "office.png"}, "robot": [robot]}
    data["robot"][0]["state"] = [*free_place(one(data, "initial-overlap")), 0]
    assert "initial-overlap" not in codes(data)


BIG = {"shape": {"name": "circle", "radius": 0.5}, "distribution": {"name": "random", "min_distance": 1.05}}


def crowd(number: int, **keys: Any) -> dict[str, Any]:
    return {"world": {"width": 8, "height": 8},
            "robot": [{**DISC, "number": number, "distribution": {"name": "random"}, **keys}]}  # fmt: skip


def test_random_placement_is_tried_with_20_seeds() -> None:
    assert codes(crowd(10)) == []
    tight = crowd(31, **BIG)
    item = one(tight, "placement-tight")
    failing = int(re.findall(r"with (\d+) of 20 seeds, not all objects find", item.message)[0])
    assert failing == sum(not places_all(tight, seed) for seed in range(20))
    assert 0 < failing < 20


def test_random_placement_that_never_works_is_an_error() -> None:
    item = one({**crowd(12), "obstacle": [box(7, 7, 4, 4)]}, "placement-crowded")
    assert item.severity == "error"
    assert "with none of 20 seeds" in item.message


def test_the_scenarios_own_seed_counts() -> None:
    data = crowd(31, **BIG)
    outcome = set()
    for seed in range(30):
        data["world"]["seed"] = seed
        works = places_all(data)
        assert ("placement-crowded" in codes(data)) is not works
        outcome.add(works)
        if outcome == {True, False}:
            break


def test_random_obstacles_on_a_goal_are_counted() -> None:
    drawn = {"name": "random", "range_low": [2, 2, -3], "range_high": [8, 8, 3]}
    posts = {"number": 14, "distribution": drawn, "shape": {"name": "circle", "radius": 0.5}}
    robot = {**DISC, "state": [1, 1, 0], "goal": [7, 7]}
    blocked = one(scenario(robot, posts, width=8, height=8), "goal-blocked").message
    assert re.match(r"in \d of 5 seeds, for example seed \d+: 'robot_0' does not fit", blocked)


def test_robots_that_share_a_goal() -> None:
    data = scenario({**DISC, "number": 3, "state": [[1, 1, 0], [1, 3, 0], [1, 5, 0]], "goal": [9, 9]})
    item = one(data, "goals-overlap")
    assert "3 robots" in item.message
    data["robot"][0]["goal"] = [[9, 9], [9, 7], [9, 5]]
    assert codes(data) == []
