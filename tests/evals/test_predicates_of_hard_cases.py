"""Predicates and properties of the hard cases: one-way aisles, rooms, timetables, tables of places, hues, speeds."""

from __future__ import annotations

from typing import Any

import pytest

from irsim.scenario.read import read
from irsim.scenario.yaml.document import load_text
from irsim_evals.grader.episode import Episode, run_episode
from irsim_evals.grader.hues import hue_of
from irsim_evals.grader.matching import Match, matches
from irsim_evals.grader.material import Material, with_speeds
from irsim_evals.grader.predicates.bodies import Each, Placed
from irsim_evals.grader.predicates.courses import Enters, OneWay, Timetable
from irsim_evals.grader.predicates.motion import EndsAt
from irsim_evals.grader.predicates.ways import Reachable
from irsim_evals.proof.mutants import mutants_of
from irsim_evals.proof.operators import plain

DRIVE = "kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, behavior: {name: dash}"
EAST = f"{{{DRIVE}, state: [1, 5, 0], goal: [9, 5, 0]}}"
WEST = f"{{{DRIVE}, state: [9, 5, 0], goal: [1, 5, 0]}}"
NORTH = f"{{{DRIVE}, state: [5, 1, 0], goal: [5, 9, 0]}}"
BOX = "{shape: {name: rectangle, length: 2, width: 1}, state: [4, 6, 0.5]}"


def world(robots: list[str], obstacles: tuple[str, ...] = ()) -> Material:
    text = "world: {width: 10, height: 10}\n"
    text += f"robot: [{', '.join(robots)}]\n" if robots else ""
    text += f"obstacle: [{', '.join(obstacles)}]\n" if obstacles else ""
    return Material(scenario=read(load_text(text)).scenario, selectors={}, texts={"scenario.yaml": text})


def episode(material: Material, seconds: float = 12) -> Episode:
    assert material.scenario is not None
    return run_episode(material.scenario, 0, seconds)


@pytest.mark.parametrize(
    ("robot", "direction", "number", "passes"),
    [
        (EAST, 0, 1, True),
        (WEST, "180deg", 1, True),
        (EAST, 0, 2, False),  # only one passes
        (WEST, 0, 0, False),  # against the direction
        (NORTH, 0, 0, True),  # crosses the aisle and does not pass through it
        (f"{{{DRIVE}, state: [1, 5, 0], waypoints: [[9, 5], [4, 5]]}}", 0, 1, False),  # comes back
    ],
)
def test_an_aisle_is_one_way(robot: str, direction: Any, number: int, passes: bool) -> None:
    material = world([robot])
    aisle = OneWay.model_validate({"of": "robots", "region": [2, 4, 8, 6], "direction": direction, "number": number})
    seen = aisle.observe(material, episode(material, 16))
    assert seen.passed == passes
    assert "toward" in seen.expected


@pytest.mark.parametrize(
    ("regions", "avoids", "observed"),
    [
        ([[4, 4, 6, 6], [8, 4, 10, 6]], [], "all 1"),
        ([[8, 4, 10, 6], [4, 4, 6, 6]], [], "does not come to [4, 4, 6, 6] after the others"),
        ([[4, 7, 6, 9]], [], "does not come to [4, 7, 6, 9]"),
        ([[8, 4, 10, 6]], [[4, 4, 6, 6]], "comes into [4, 4, 6, 6]"),
    ],
)
def test_rooms_are_entered_in_their_order(regions: Any, avoids: Any, observed: str) -> None:
    material = world([EAST])
    seen = Enters.model_validate({"of": "robots", "regions": regions, "avoids": avoids}).observe(
        material, episode(material)
    )
    assert observed in seen.observed
    assert seen.passed == (observed == "all 1")


@pytest.mark.parametrize(
    ("robots", "times", "passes"),
    [
        ([EAST], [4], True),
        ([EAST], [5], False),
        ([EAST], [4, 8], False),  # there is only one
        ([EAST, WEST], [4, 4], True),
        ([NORTH], [4], False),  # drives along the line
    ],
)
def test_a_line_is_crossed_on_time(robots: list[str], times: list[float], passes: bool) -> None:
    material = world([robot.replace("radius: 0.2}", "radius: 0.2}, unobstructed: true") for robot in robots])
    table = Timetable.model_validate({"of": "robots", "start": [5, 0], "end": [5, 10], "times": times, "tol": 0.2})
    assert table.observe(material, episode(material)).passed == passes


@pytest.mark.parametrize(
    ("rows", "observed"),
    [
        ([{"x": 4, "axis": 0.5}, {"shape": "circle"}], "all 2"),
        ([{"x": 4, "axis": 0.5}], "in no row"),
        ([{"x": 4, "axis": 0.7}, {"shape": "circle"}], "no body with x 4; axis 0.7"),
        ([{"y": {"ge": 1}}, {"y": 6}], "all 2"),  # the first row fits both, the second only one
    ],
)
def test_a_table_has_a_row_for_each_body(rows: Any, observed: str) -> None:
    material = world([], (BOX, "{shape: {name: circle, radius: 0.3}, state: [8, 2, 0]}"))
    seen = Placed.model_validate({"of": "obstacles", "rows": rows}).observe(material, material.scene(0))
    assert observed in seen.observed
    assert seen.passed == (observed == "all 2")


@pytest.mark.parametrize(("axis", "passes"), [(0.5, True), (0.5 - 3.14159, True), (0.5 + 1.5708, False)])
def test_a_direction_and_its_opposite_are_one_axis(axis: float, passes: bool) -> None:
    assert matches(Match(eq=axis), 0.5, "axis") == passes


@pytest.mark.parametrize(("share", "passes"), [({"ge": 0.3, "le": 0.5}, True), ({"ge": 0.9}, False)])
def test_a_body_ends_on_a_part_of_its_way(share: Any, passes: bool) -> None:
    material = world([EAST], ("{shape: {name: rectangle, length: 0.2, width: 4}, state: [5, 5, 0]}",))
    seen = EndsAt.model_validate({"of": "robots", "share": share}).observe(material, episode(material))
    assert seen.passed == passes


@pytest.mark.parametrize(("gap", "passes"), [(1.0, True), (0.2, False)])
def test_a_place_may_be_reachable_although_it_is_no_goal(gap: float, passes: bool) -> None:
    walls = (
        f"{{shape: {{name: rectangle, length: 0.2, width: {5 - gap / 2}}}, state: [6, {(5 - gap / 2) / 2}, 0]}}",
        f"{{shape: {{name: rectangle, length: 0.2, width: {5 - gap / 2}}}, state: [6, {10 - (5 - gap / 2) / 2}, 0]}}",
    )
    material = world([f"{{{DRIVE}, state: [1, 5, 0], goal: [3, 5, 0]}}"], walls)
    reachable = Reachable.model_validate({"of": "robots", "to": [9, 5]})
    assert reachable.observe(material, material.scene(0)).passed == passes


@pytest.mark.parametrize(
    ("color", "hue"),
    [
        ("#ff8c00", "orange"), ("#ffa500", "orange"), ("#d62728", "red"), ("#1f77b4", "blue"), ("#228b22", "green"),
        ("#8b4513", "brown"), ("#696969", "grey"), ("#ffffff", "white"), ("#000000", "black"), ("#ffd700", "yellow"),
        ("#ffc0cb", "pink"), ("#800080", "purple"), (None, None), ("cycle", None),
    ],
)  # fmt: skip
def test_colors_have_everyday_names(color: str | None, hue: str | None) -> None:
    assert hue_of(color) == hue


def test_limits_to_the_left_and_to_the_right_are_told_apart() -> None:
    robot = "{kinematics: {name: diff}, state: [1, 5, 0], vel_max: [1, 0.5], vel_min: [0, -0.8]}"
    material = world([robot])
    for has, passes in (({"turn_left": 0.5, "turn_right": 0.8}, True), ({"turn_right": 0.5}, False)):
        each = Each.model_validate({"of": "robots", "has": has})
        assert each.observe(material, material.scene(0)).passed == passes


def test_an_episode_may_have_other_speed_limits() -> None:
    material = world([EAST, NORTH])
    assert material.scenario is not None
    slow = run_episode(with_speeds(material.scenario, material, 0, {"robots": 0.5}), 0, 2)
    fast = episode(material, 2)
    assert slow.positions(0)[-1][0] - 1 == pytest.approx((fast.positions(0)[-1][0] - 1) / 2, abs=0.05)
    assert material.scenario.objects[0].vel_max[0] == 1


def test_a_mutant_of_one_entry_leaves_those_that_share_an_anchor() -> None:
    shape = {"name": "circle", "radius": 0.2}
    data = {"robot": [{"shape": shape, "state": [1, 1, 0]}, {"shape": shape, "state": [3, 3, 0]}]}
    assert plain(data) == data
    half = [mutant.data for mutant in mutants_of(data) if mutant.what == "robot[0]: shape.radius x 0.5"]
    assert [entry["shape"]["radius"] for entry in half[0]["robot"]] == [0.1, 0.2]
