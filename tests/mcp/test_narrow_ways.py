"""Narrow ways in a look: hint, table and first line name the same gaps, and what to do about them."""

from __future__ import annotations

import re

import pytest

from tests.mcp.conftest import Caller

pytestmark = pytest.mark.anyio

PERLIN = """\
world:
  width: 25
  height: 25
  obstacle_map: {name: perlin, resolution: 0.2, fill: 0.25, seed: 31}
robot:
  - name: ranger
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.25}
    state: [2, 2, 0.8]
    goal: [19.5, 18.7]
    goal_threshold: 0.3
    vel_max: [1.2, 2.0]
    vel_min: [0, -2.0]
    behavior: {name: follow, planner: astar, local: dash}
"""
CORNER = """\
world: {width: 12, height: 8, boundary: walls}
robot:
  - {name: rover, kinematics: {name: omni}, shape: {name: circle, radius: 0.25}, state: [2, 2, 0],
     waypoints: [[10, 2], [2, 2], [10, 2]], behavior: {name: follow}}
  - {name: dasher, kinematics: {name: omni}, shape: {name: circle, radius: 0.25}, state: [2, 3, 0],
     waypoints: [[10, 3], [2, 3]], behavior: {name: orca}}
obstacle:
  - {name: box, shape: {name: rectangle, length: 1, width: 4}, state: [6, 2]}
"""


async def looked(client: Caller, text: str, **more: object) -> dict[str, str]:
    """The line of the picture, the finding about a path, and the row of the table about passages."""
    lines = (
        await client.text("render_snapshot", scenario_yaml=text, overlays=["plan"], return_image=False, **more)
    ).splitlines()
    kinds = {"finding": r"1\. .*(narrow-passage|goal-unreachable)", "table": "Narrowest passage"}
    first_lines = {kind: line for kind, start in kinds.items() for line in lines if re.match(start, line)}
    return {"first": lines[0], **first_lines}


def places(line: str) -> set[str]:
    return set(re.findall(r"\(-?\d+\.\d\d, -?\d+\.\d\d\)", line))


async def test_hint_table_and_first_line_name_the_same_gaps(client: Caller) -> None:
    told = await looked(client, PERLIN)
    gaps = places(told["table"])
    assert "0.6 m at (" in told["table"]
    assert "leads through 2 gaps of 0.6 m at (" in told["finding"]
    assert places(told["finding"].partition(" Fix: ")[0]) == gaps
    assert "to the map at (" in told["first"]
    (_, gap) = re.findall(r"\(\d+\.\d\d, \d+\.\d\d\)", told["first"])
    assert f"in the passage of 0.6 m at {gap}" in told["first"]
    assert gap in gaps


async def test_a_map_drawn_by_its_seed_has_another_goal_as_fix(client: Caller) -> None:
    narrow = (await looked(client, PERLIN))["finding"].partition(" Fix: ")[2]
    closed = (await looked(client, PERLIN.replace("[19.5, 18.7]", "[23, 23]")))["finding"].partition(" Fix: ")[2]
    assert narrow.startswith("another goal: (")
    assert closed.startswith("another goal: it can get to (")
    for fix in (narrow, closed):
        assert "a gap of" not in fix
        assert "another 'seed'" in fix
    for fix in (narrow, closed):
        (place,) = re.findall(r"\((\d+\.\d\d, \d+\.\d\d)\)", fix)
        told = await looked(client, PERLIN.replace("19.5, 18.7", place))
        assert "goal-unreachable" not in told.get("finding", "")
        assert fix is closed or "finding" not in told


async def test_plans_are_those_that_follow_drives_to_every_goal(client: Caller) -> None:
    first = (await looked(client, CORNER))["first"]
    own, other = re.findall(r"(?:its own plan|a path) for '\w+': [^;]*", first)
    margin = float(re.findall(r"least margin ([\d.]+) m to 'box'", own)[0])
    assert margin > 0.05
    assert "corner" not in own
    assert "a path for 'dasher': " in other
    assert "to 'box' at (" in other
    assert "(a shortest path, which touches corners or nearly so)" in other


async def test_a_robot_that_comes_later_has_no_plan_before(client: Caller) -> None:
    late = CORNER.replace("behavior: {name: orca}", "appear_time: 0.5, behavior: {name: follow}")
    told = [(await looked(client, late, step=step))["first"] for step in (0, 2, 10)]
    assert ["its own plan for 'dasher'" in line for line in told] == [False, False, True]
    assert all("its own plan for 'rover'" in line for line in told)
