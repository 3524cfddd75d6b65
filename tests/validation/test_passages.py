"""Ways in worlds that are large for those who move there: the gaps between things, exactly."""

from __future__ import annotations

import math
import time
from typing import Any

import numpy as np
import pytest

import irsim
import irsim._core as core
from irsim.validation.feasibility.gaps import find_gaps
from irsim.validation.feasibility.scenes import FAR, StartState
from tests.validation.test_findings import DISC, box, codes, findings

pytestmark = pytest.mark.one_python
LONG = (pytest.mark.slow, pytest.mark.rotates(4))

ROBOT = {"kinematics": {"name": "diff"}, "behavior": {"name": "follow"}, "state": [5, 5, 0]}


def world(size: float, *obstacles: dict[str, Any], radius: float = 0.3, **more: Any) -> dict[str, Any]:
    boundary = more.pop("boundary", "walls")
    robot = {**ROBOT, "shape": {"name": "circle", "radius": radius}, "goal": [size - 5, size - 5], **more}
    return {
        "world": {"width": size, "height": size, "boundary": boundary},
        "robot": [robot],
        "obstacle": list(obstacles),
    }


def line(*points: tuple[float, float]) -> dict[str, Any]:
    return {"shape": {"name": "linestring", "vertices": [list(p) for p in points]}, "state": [0, 0, 0]}


def door(size: float, gap: float, **more: Any) -> dict[str, Any]:
    """A wall across the world with a door."""
    x, y = size / 2, 0.7 * size
    return world(size, line((x, 0), (x, y)), line((x, y + gap), (x, size)), **more)


@pytest.mark.parametrize(("size", "radius"), [(60, 0.15), (100, 0.3), (400, 0.3), (3000, 0.2)])
def test_a_wall_across_a_world_is_found_however_large_it_is(size: float, radius: float) -> None:
    (item,) = findings(world(size, line((size / 2, 0), (size / 2, size)), radius=radius))
    assert (item.code, item.severity) == ("goal-unreachable", "warning")
    assert "obstacles separate them completely" in item.message


@pytest.mark.parametrize("size", [50, *(pytest.param(size, marks=LONG) for size in (100, 200, 300, 1000))])
@pytest.mark.parametrize(
    ("gap", "code"), [(0.5, "goal-unreachable"), (0.58, "goal-unreachable"), (0.66, "narrow-passage"), (0.8, None)]
)
def test_a_door_is_measured_in_worlds_of_every_size(size: float, gap: float, code: str | None) -> None:
    items = findings(door(size, gap))
    assert [item.code for item in items] == ([code] if code else [])
    if size > 100 and code:
        assert f"a gap of {gap:g} m at ({size / 2:.2f}, {0.7 * size:.0f}." in items[0].message


def test_an_open_edge_is_no_way_and_told() -> None:
    (item,) = findings(world(300, line((150, 0), (150, 300)), boundary="none"))
    assert "only outside the world" in item.message
    ring = line((280, 280), (299, 280), (299, 299), (280, 299), (280, 280))
    (item,) = findings(world(300, ring, boundary="none"))
    assert (item.code, "outside of the world" in item.message) == ("goal-unreachable", False)


def test_a_way_round_is_a_way() -> None:
    assert codes(world(300, line((150, 0), (150, 298)))) == []
    corner = line((260, 299.8), (260, 250), (299.5, 250))  # a corner cut off, open nowhere
    assert codes(world(300, corner)) == ["goal-unreachable"]
    assert codes(world(300, line((260, 297), (260, 250), (299.5, 250)))) == []


def test_a_wall_short_of_the_goal_does_not_matter_where_it_counts_as_arrived_before() -> None:
    wall = line((294.5, 280), (294.5, 299.9))
    near = line((290, 294.5), (300, 294.5))
    for threshold in (0.9, 1.5):
        assert codes(world(300, wall, near, goal_threshold=threshold, goal=[295, 295])) == []
    closed = [line((290, 0), (290, 300)), line((294.6, 280), (294.6, 299.9))]
    assert codes(world(300, *closed, goal_threshold=1.5, goal=[295.2, 295])) == ["goal-unreachable"]


def test_a_map_in_a_large_world_is_looked_at_too() -> None:
    data = world(300, line((150, 0), (150, 300)))
    data["world"]["obstacle_map"] = {"name": "perlin", "resolution": 1, "fill": 0.02, "seed": 3}
    data["robot"][0].update(state=[15, 20, 0], goal=[280, 280])
    assert codes(data) == ["goal-unreachable"]


def test_what_is_too_much_is_told_and_costs_little() -> None:
    data = world(600, goal=[9, 9], state=[1, 1, 0])
    data["world"]["obstacle_map"] = {"name": "perlin", "resolution": 1, "fill": 0.3, "seed": 3}
    assert codes(data) == ["way-unchecked"]
    data["robot"][0]["goal"] = [2, 1.4]  # nothing in between
    assert codes(data) == []
    begin = time.process_time()
    findings(data)
    assert time.process_time() - begin < 2


SLANTED = """\
world: {{width: 12, height: 10, boundary: walls}}
robot:
  - {{kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.3}}, state: [1, 5, 0], {goal},
     behavior: {{name: follow, planner: {planner}}}}}
obstacle:
  - {{shape: {{name: polygon, vertices: [[4, 0], [5, 0], [4.5, 4.8]]}}, state: [0, 0, 0]}}
  - {{shape: {{name: circle, radius: 1}}, state: [4.5, 6.45, 0]}}
  - {{shape: {{name: rectangle, length: 0.2, width: 3.2}}, state: [4.5, 8.9, 0]}}
"""


@pytest.mark.parametrize("goal", ["goal: [11, 5]", "waypoints: [[2, 2], [11, 5]]", "waypoints: [[2, 7], [11, 5]]"])
def test_a_gap_that_the_planner_cannot_see_is_a_warning_with_cells_that_show_it(goal: str) -> None:
    text = SLANTED.format(goal=goal, planner="astar")
    (item,) = irsim.validate(text=text).findings
    assert (item.code, item.severity) == ("narrow-passage", "warning")
    assert "It does not move, because its planner 'astar' with cells of 0.1 m does not find that path" in item.message
    assert irsim.run(text=text).outcome == "timeout"
    assert item.fix is not None
    planner = item.fix.partition("planner: ")[2].partition("} ")[0] + "}"
    mended = SLANTED.format(goal=goal, planner=planner)
    (item,) = irsim.validate(text=mended).findings
    assert (item.code, item.severity) == ("narrow-passage", "hint")
    assert irsim.run(text=mended).outcome == "success"


def test_a_gap_that_a_robot_without_planner_has_to_find_is_a_hint() -> None:
    text = SLANTED.format(goal="goal: [11, 5]", planner="astar").replace("name: follow, planner: astar", "name: orca")
    assert [item.severity for item in irsim.validate(text=text).findings if item.code == "narrow-passage"] == ["hint"]


def random_things(rng: np.random.Generator, low: float, high: float) -> list[Any]:
    things: list[Any] = []
    for _ in range(int(rng.integers(3, 14))):
        pose = [*rng.uniform(low, high, 2), rng.uniform(-3, 3)]
        kind = rng.integers(3)
        if kind == 0:
            things.append(([core.Circle(radius=rng.uniform(0.1, 1.5), center=[0, 0])], pose))
        elif kind == 1:
            a, b = rng.uniform(0.05, 2.5, 2)
            things.append(([core.Polygon(vertices=[[-a, -b], [a, -b], [a, b], [-a, b]])], pose))
        else:
            things.append(([core.Linestring(vertices=rng.uniform(-3, 3, (3, 2)).tolist())], pose))
    return things


@pytest.mark.parametrize("open_edge", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_gaps_are_those_that_fine_cells_show(open_edge: bool) -> None:
    """Against the widest way over a lattice, whose distances are at most half a diagonal off."""
    rng = np.random.default_rng(7)
    bounds, narrow = (0.0, 0.0, 10.0, 10.0), 0
    for _ in range(20):
        low, high = (3.6, 6.4) if open_edge else (0.0, 10.0)  # cells do not see what is outside of an open edge
        things = random_things(rng, low, high)
        if not open_edge:
            things.append(([core.Room(vertices=[[0, 0], [0, 10], [10, 10], [10, 0]])], [0.0, 0.0, 0.0]))
        scene = StartState(seed=0, pose={}, goals={}, things=things, bounds=bounds)
        n = 500
        clearance = core.Clearance(core.Terrain(FAR, things), ((0.0, 0.0), (10 / n, 10 / n), n, n))
        half = math.sqrt(0.5) * 10 / n
        barriers = find_gaps(scene, most=20.0, open_edge=open_edge)
        assert barriers is not None
        distance = clearance.distance
        ways = []
        for start, goal in rng.integers(0, n, (40, 2, 2)):
            if min(distance[tuple(start)], distance[tuple(goal)]) > 0.05:
                ways.append(tuple((float(i + 0.5) * 10 / n, float(j + 0.5) * 10 / n) for i, j in (start, goal)))
        for (start, goal), opening in zip(ways, barriers.openings(ways), strict=True):
            widest = clearance.widest(start, goal, 0.0)[0]
            ends = min(distance[int(x * n / 10), int(y * n / 10)] for x, y in (start, goal))
            assert max(0.0, min(opening.width / 2, ends)) == pytest.approx(max(0.0, widest), abs=2 * half + 1e-6)
            narrow += opening.width / 2 < ends
    assert narrow > 20


def test_a_goal_between_walls_that_the_body_just_touches_can_be_reached() -> None:
    walls = [box(6, 1, 8, y) for y in (3.8, 2.2)]
    robot = {**DISC, "behavior": {"name": "dash"}, "state": [1, 3, 0], "goal": [8, 3, 0], "goal_threshold": 0.05}
    data = {"world": {"width": 12, "height": 6}, "robot": [robot], "obstacle": walls}
    assert "goal-blocked" not in codes(data)
    walls[0]["state"] = [8, 3.79, 0]
    assert "goal-blocked" in codes(data)
