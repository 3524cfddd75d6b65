"""The narrowest place on a way, and the tools that an agent called."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from irsim_evals.grader.artefact import Answer, Call
from irsim_evals.grader.limited import grade_folder
from irsim_evals.grader.material import Material
from tests.evals.conftest import RIGHT, failed, made_up, seen, world

WALLS = "world: {width: 10, height: 6, boundary: walls}"
OPEN = "world: {width: 10, height: 6}"
ROBOT = "kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 3, 0], goal: [9, 3, 0]"


def box(x0: float, y0: float, x1: float, y1: float) -> str:
    size, middle = (x1 - x0, y1 - y0), ((x0 + x1) / 2, (y0 + y1) / 2)
    return f"{{shape: {{name: rectangle, length: {size[0]}, width: {size[1]}}}, state: [{middle[0]}, {middle[1]}, 0]}}"


def scene(head: str, *obstacles: str, robot: str = ROBOT) -> Material:
    return world(f"{head}\nrobot: [{{{robot}}}]\nobstacle: [{', '.join(obstacles)}]\n")


DOOR = (box(4.9, 0, 5.1, 2.6), box(4.9, 3.5, 5.1, 6))
"""A wall across the world with a door of 0.9 m."""


@pytest.mark.parametrize(
    ("material", "width"),
    [
        (scene(WALLS, *DOOR), 0.9),
        (scene(OPEN, *DOOR), 0.9),
        (scene(WALLS, *DOOR, box(6.9, 0.7, 7.1, 6)), 0.7),  # a second wall whose gap is narrower
        (scene(WALLS, *DOOR, box(9.3, 2.6, 9.5, 3.4)), 0.9),  # the goal lies near to a box
        (scene(WALLS, *DOOR, box(0.7, 2, 0.78, 4)), 0.9),  # so does the start
        (scene(WALLS, box(4.9, 0, 5.1, 2.6), box(4.9, 3.5, 5.1, 4.8)), 1.2),  # the widest way leads past the door
        (scene(OPEN, box(4.9, 0, 5.1, 5)), 1),  # the edge counts as a wall
        (scene(WALLS, box(4.9, 0, 5.1, 5)), 1),
        (scene(WALLS, box(4.9, 0, 5.1, 6)), 0),  # no way
        (scene(WALLS), 6),
        (scene(OPEN), 6),
        (scene(OPEN, box(0, 1.9, 10, 2), box(0, 4, 10, 4.2)), 2),  # along a corridor
        (scene(OPEN, box(0, 1.9, 10, 2), box(0, 4, 8, 4.2), box(8, 3.5, 9, 4.2)), 1.5),  # the goal is in its bottleneck
        # slanted: the two discs are 5 * 0.3 m apart
        (scene(WALLS, *(f"{{shape: {{name: circle, radius: 0.5}}, state: [{x}, {y}, 0]}}" for x, y in
                        [(5, 0.5), (5, 1.5), (5, 2.5), (6.5, 4.5), (6.5, 5.5)])), 1.5),
        (scene(WALLS, *DOOR, robot=ROBOT.replace("goal: [9, 3, 0]", "waypoints: [[3, 3], [4, 5]]")), 4.9),
    ],
)  # fmt: skip
def test_a_bottleneck_is_as_wide_as_its_gap(material: Material, width: float) -> None:
    exact = {"eq": width, "tol": 0.02}
    assert seen(material, "bottleneck", {"of": "robots", "width": exact}).passed
    for wrong in (width + 0.05, width - 0.05):
        observation = seen(material, "bottleneck", {"of": "robots", "width": {"eq": wrong, "tol": 0.02}})
        assert not observation.passed
        assert observation.marks


def test_the_only_way_is_closed_with_its_bottleneck() -> None:
    only = {"of": "robots", "only": True}
    assert seen(scene(WALLS, *DOOR), "bottleneck", only).passed
    two_doors = scene(WALLS, box(4.9, 0, 5.1, 1), box(4.9, 1.9, 5.1, 4), box(4.9, 4.9, 5.1, 6))
    assert not seen(two_doors, "bottleneck", only).passed
    assert seen(two_doors, "bottleneck", {"of": "robots", "width": {"eq": 0.9, "tol": 0.02}}).passed


def test_nobody_has_no_bottleneck() -> None:
    material = scene(WALLS, *DOOR)
    assert not seen(material, "bottleneck", {"of": "statics", "width": {"ge": 0}}).passed


def test_a_map_has_bottlenecks_too() -> None:
    """The narrowest place of a Perlin map is as wide as the largest disc that gets through."""
    noise = "obstacle_map: {name: perlin, resolution: 0.2, fill: 0.3, seed: 3}"
    robot = ROBOT.replace("[1, 3, 0]", "[2.2, 3.6, 0]").replace("[9, 3, 0]", "[9.1, 2.5]")
    material = scene(f"world: {{width: 10, height: 6, boundary: walls, {noise}}}", robot=robot)
    width = 2 * material.scene(0).path_width((2.2, 3.6), (9.1, 2.5), 0.05)
    assert 0.8 < width < 0.9
    assert seen(material, "bottleneck", {"of": "robots", "width": {"eq": width, "tol": 0.03}}).passed


def log(*calls: str) -> tuple[Call, ...]:
    """Calls by their names; a ``!`` behind a name is a refusal."""
    return tuple(Call(tool=name.rstrip("!"), error=name.endswith("!"), tokens=1) for name in calls)


LOG = log(
    "lookup", "write_scenario!", "write_scenario", "validate_scenario", "write_file", "run_episode", "run_episode!"
)


@pytest.mark.parametrize(
    ("keys", "passes"),
    [
        ({}, True),
        ({"number": 7, "refused": 2}, True),
        ({"number": 6}, False),
        ({"refused": 0}, False),
        ({"tool": "run_episode"}, True),
        ({"tool": "benchmark"}, False),
        ({"tool": "benchmark", "number": 0}, True),
        ({"tool": "run_episode", "number": 2, "refused": 1}, True),
        ({"order": ["lookup", "write_scenario", "run_episode"]}, True),
        ({"order": ["run_episode", "lookup"]}, False),
        ({"order": ["run_episode", "run_episode"]}, False),  # the second was refused
        ({"order": ["write_*", "write_*"]}, True),
        ({"order": ["write_*", "write_*", "write_*"]}, False),
        ({"tool": "run_*", "order": ["lookup"]}, False),
        ({"when": "after_last_write", "tool": "run_episode"}, True),
        ({"when": "after_last_write", "tool": "validate_scenario"}, False),
        ({"when": "before_last_write", "tool": "validate_scenario"}, True),
        ({"when": "before_last_write", "number": 4}, True),
        ({"when": "after_last_write", "number": 2}, True),
    ],
)
def test_calls_are_counted(keys: dict[str, Any], passes: bool) -> None:
    material = Material(Answer("x", calls=LOG))
    assert seen(material, "calls", keys).passed == passes


def test_without_a_write_nothing_comes_after_it() -> None:
    material = Material(Answer("x", calls=log("lookup", "write_scenario!")))
    assert not seen(material, "calls", {"when": "after_last_write"}).passed
    assert seen(material, "calls", {"when": "before_last_write", "number": 2}).passed


@pytest.mark.parametrize("keys", [{}, {"number": 0}, {"tool": "run_episode", "number": 0}])
def test_without_a_log_nothing_is_known_of_calls(keys: dict[str, Any]) -> None:
    observation = seen(Material(Answer("x")), "calls", keys)
    assert not observation.passed
    assert "--log-calls" in observation.observed


def test_the_log_in_the_folder_is_read(tmp_path: Path) -> None:
    case = made_up({"id": "checked", "calls": {"tool": "validate_scenario", "when": "after_last_write"}}, seeds=[0])
    (tmp_path / "scenario.yaml").write_text(RIGHT, encoding="utf-8")
    assert failed(grade_folder(case, tmp_path)) == ["checked"]
    lines = [json.dumps({"tool": name, "error": False, "tokens": 3}) for name in ("write_file", "validate_scenario")]
    (tmp_path / "calls.jsonl").write_text("\n".join(lines), encoding="utf-8")
    verdict = grade_folder(case, tmp_path)
    assert (failed(verdict), verdict.cost.calls) == ([], 2)
    (tmp_path / "calls.jsonl").write_text("\n".join(lines[::-1]), encoding="utf-8")
    assert failed(grade_folder(case, tmp_path)) == ["checked"]
