"""Predicates about worlds at their start: ones that are right, and ones that are wrong in one respect."""

from __future__ import annotations

from typing import Any

import pytest

from irsim_evals.cases.model import Pin
from irsim_evals.cases.store import case_of
from irsim_evals.grader.hues import hue_of
from irsim_evals.grader.matching import Match, matches
from irsim_evals.grader.properties import value_of
from irsim_evals.proof.changes import changed_facts, touches
from irsim_evals.proof.mutants import mutants_of
from irsim_evals.proof.operators import plain
from tests.evals.conftest import seen, world

DISC = "shape: {name: circle, radius: 0.2}"
SKETCH = {"sketch": "####\n#..#\n#.##\n", "cell": [2, 2], "tol": 0.1}
RING = """
world: {width: 8, height: 6}
obstacle:
  - {shape: {name: rectangle, length: 8, width: 2}, state: [4, 5, 0]}
  - {shape: {name: rectangle, length: 2, width: 4}, state: [1, 2, 0]}
  - {shape: {name: polygon, vertices: [[4, 0], [8, 0], [8, 4], [6, 4], [6, 2], [4, 2]]}, state: [0, 0, 0]}
"""
POSTS = """
world: {width: 9, height: 9}
obstacle:
  - {shape: {name: circle, radius: 0.5}, state: [2, 2, 0]}
  - {shape: {name: rectangle, length: 2, width: 1}, state: [6, 6, 0]}
"""
TABLE = """
world: {width: 10, height: 10}
obstacle:
  - {shape: {name: rectangle, length: 2, width: 1}, state: [4, 6, 0.5]}
  - {shape: {name: circle, radius: 0.3}, state: [8, 2, 0]}
"""


@pytest.mark.parametrize(
    ("second", "passes"),
    [
        ("state: [9, 5.5, 0], goal: [1, 5.5, 0]", True),
        ("state: [9, 7, 0], goal: [1, 7, 0]", False),  # too far beside the first way
        ("state: [1, 5.5, 0], goal: [9, 5.5, 0]", False),  # the same direction
        ("state: [9, 5.5, 0]", False),  # no goal
    ],
)
def test_ways_of_two_robots_lead_past_each_other(second: str, passes: bool) -> None:
    robots = (f"{{kinematics: {{name: diff}}, {way}, {DISC}}}" for way in ("state: [1, 5, 0], goal: [9, 5, 0]", second))
    material = world(f"world: {{width: 10, height: 10}}\nrobot: [{', '.join(robots)}]\n")
    assert seen(material, "ways", {"of": "robots", "angle": {"ge": "160deg"}, "distance": {"le": 1}}).passed == passes


@pytest.mark.parametrize(("x", "observed"), [(7.0, "so it is"), (8.0, "its walls leave a gap")])
def test_the_walls_of_a_pocket_are_connected(x: float, observed: str) -> None:
    material = world(
        "world: {width: 14, height: 14}\n"
        "robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [7, 2, 0], goal: [7, 12, 0]}\n"
        "obstacle:\n"
        f"  - {{shape: {{name: rectangle, length: 3.4, width: 0.2}}, state: [{x}, 8.1, 0]}}\n"
        "  - {shape: {name: rectangle, length: 0.2, width: 2}, state: [5.4, 7, 0]}\n"
        "  - {shape: {name: rectangle, length: 0.2, width: 2}, state: [8.6, 7, 0]}\n"
    )
    pocket = {"of": "robots", "width": {"eq": 3, "tol": 0.4}, "depth": {"eq": 2, "tol": 0.4}}
    assert seen(material, "pocket", pocket).observed == observed


@pytest.mark.parametrize(
    ("old", "new", "observed"),
    [
        ("", "", "as in the drawing"),
        ("[4, 5, 0]", "[4, 5.05, 0]", "as in the drawing"),  # within the tolerance
        ("height: 6}", "height: 6, boundary: walls}", "as in the drawing"),  # walls round the world do not count
        ("length: 8, width: 2}, state: [4, 5, 0]", "length: 7, width: 2}, state: [3.5, 5, 0]", "missing"),
        ("state: [1, 2, 0]", "state: [2, 2, 0]", "missing"),
        ("state: [4, 5, 0]", "state: [4, 5, 0], unobstructed: true", "missing"),
        ("length: 2, width: 4}, state: [1", "length: 3, width: 4}, state: [1.5", "too much"),
        ("obstacle:", "obstacle:\n  - {shape: {name: linestring, vertices: [[2.5, 1], [3.5, 3]]}, state: [0, 0, 0]}",
         "too much"),
    ],
)  # fmt: skip
def test_everything_solid_agrees_with_a_sketch(old: str, new: str, observed: str) -> None:
    observation = seen(world(RING.replace(old, new) if old else RING), "plan", SKETCH)
    assert observation.observed.startswith(observed)
    assert observation.passed == (observed == "as in the drawing")
    assert bool(observation.marks) != observation.passed


@pytest.mark.parametrize(
    ("plan", "passes"),
    [
        ({"discs": [[2, 2, 0.5]], "boxes": [[5, 5.5, 7, 6.5]], "tol": 0.05}, True),
        ({"discs": [[2, 2, 0.7]], "boxes": [[5, 5.5, 7, 6.5]], "tol": 0.05}, False),
        ({"discs": [[2, 2, 0.7]], "boxes": [[5, 5.5, 7, 6.5]], "ignore": [[1, 1, 3, 3]]}, True),
        ({}, False),  # a plan of nothing fulfils nothing
    ],
)
def test_boxes_and_discs_of_a_plan_and_what_it_ignores(plan: dict[str, Any], passes: bool) -> None:
    assert seen(world(POSTS), "plan", plan).passed == passes


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
    observation = seen(world(TABLE), "placed", {"of": "obstacles", "rows": rows})
    assert observed in observation.observed
    assert observation.passed == (observed == "all 2")


@pytest.mark.parametrize(("gap", "passes"), [(1.0, True), (0.2, False)])
def test_a_place_may_be_reachable_although_it_is_no_goal(gap: float, passes: bool) -> None:
    width = 5 - gap / 2
    wall = "{shape: {name: rectangle, length: 0.2, width: %s}, state: [6, %s, 0]}"
    material = world(
        "world: {width: 10, height: 10}\n"
        f"robot: {{kinematics: {{name: omni}}, {DISC}, behavior: {{name: dash}}, state: [1, 5, 0], goal: [3, 5, 0]}}\n"
        f"obstacle: [{wall % (width, width / 2)}, {wall % (width, 10 - width / 2)}]\n"
    )
    assert seen(material, "reachable", {"of": "robots", "to": [9, 5]}).passed == passes


@pytest.mark.parametrize(
    ("has", "passes"), [({"turn_left": 0.5, "turn_right": 0.8}, True), ({"turn_right": 0.5}, False)]
)
def test_limits_to_the_left_and_to_the_right_are_told_apart(has: dict[str, float], passes: bool) -> None:
    material = world("robot: {kinematics: {name: diff}, state: [1, 5, 0], vel_max: [1, 0.5], vel_min: [0, -0.8]}")
    assert seen(material, "each", {"of": "robots", "has": has}).passed == passes


@pytest.mark.parametrize(("limit", "angle"), [(0.3, 0.3), (1.0, 0.4)])
def test_the_steering_angle_is_the_smaller_of_two_limits(limit: float, angle: float) -> None:
    limits = f"vel_max: [1, {limit}], vel_min: [-1, -{limit}]"
    scene = world(f"robot: {{kinematics: {{name: acker, wheelbase: 1, psi_max: 0.4}}, {limits}}}").scene(0)
    assert value_of(scene, scene.bodies[0], "steer") == pytest.approx(angle)


@pytest.mark.parametrize(("axis", "passes"), [(0.5, True), (0.5 - 3.14159, True), (0.5 + 1.5708, False)])
def test_a_direction_and_its_opposite_are_one_axis(axis: float, passes: bool) -> None:
    assert matches(Match(eq=axis), 0.5, "axis") == passes


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


def test_the_cells_of_a_map_are_filled() -> None:
    scene = world("world: {width: 12, height: 9, obstacle_map: {name: perlin, resolution: 0.5, seed: 3}}\n").scene(0)
    cells = scene.terrain_views[0].cells.count
    assert cells > 50
    assert scene.solid.area == pytest.approx(cells * 0.25)


def test_a_mutant_of_one_entry_leaves_those_that_share_an_anchor() -> None:
    shape = {"name": "circle", "radius": 0.2}
    data = {"robot": [{"shape": shape, "state": [1, 1, 0]}, {"shape": shape, "state": [3, 3, 0]}]}
    assert plain(data) == data
    half = [made for _, what, made in mutants_of(data) if what == "robot[0]: shape.radius x 0.5"]
    assert [entry["shape"]["radius"] for entry in half[0]["robot"]] == [0.1, 0.2]


def test_a_body_that_a_mutant_adds_belongs_to_the_pin_whose_selection_holds_it() -> None:
    text = (
        "world: {width: 9, height: 9}\n"
        "robot: {kinematics: {name: diff}, sensors: [{name: lidar2d, angle_range: 6.28}]}\n"
    )
    before = world(text).scene(0)
    after = world(f"{text}obstacle: {{shape: {{name: circle, radius: 0.5}}, state: [5, 5, 0]}}\n").scene(0)
    changed = changed_facts(before, after)
    assert [kind for _, kind in changed] == ["count"]
    case = case_of("pub-01").case
    assert not touches(case, (before, after), changed, [Pin(of="robots", facts=["count"])])
    assert touches(case, (before, after), changed, [Pin(of="obstacles", facts=["count"])]) == changed
    assert not changed_facts(before, world(text.replace("6.28", "360")).scene(0))  # both see all round
    one = changed_facts(before, world(text.replace("angle_range", "number: 50, angle_range")).scene(0))
    assert {kind for _, kind in one} == {"beams"}
    assert touches(case, (before, before), one, [Pin(of="robots", facts=["sensors"])]) == one


@pytest.mark.parametrize(
    ("keys", "distance"),
    [
        # the way leads along y = 5 from x = 1 to 9; the posts stand at (5, 7) and (5, 4), (11, 9) is beyond the goal
        ({"what": "way", "to": "posts"}, 1),
        ({"what": "way", "to": "posts", "which": "farthest"}, 20**0.5),
        ({"what": "way", "to": "posts", "which": "middle"}, 5 / 3),
        ({"what": "way", "place": [0, 5]}, 1),
        ({"what": "position", "to": "posts", "which": "middle"}, (6**2 + (5 / 3) ** 2) ** 0.5),
        ({"what": "goal", "to": "posts", "which": "nearest"}, 17**0.5),
    ],
)
def test_a_way_is_near_to_a_middle(keys: dict[str, Any], distance: float) -> None:
    posts = ", ".join(f"{{{DISC}, state: [{x}, {y}, 0]}}" for x, y in ((5, 7), (5, 4), (11, 9)))
    robot = f"{{kinematics: {{name: diff}}, {DISC}, state: [1, 5, 0], goal: [9, 5, 0]}}"
    text = f"world: {{width: 12, height: 10}}\nrobot: [{robot}, {{{DISC}, state: [1, 1, 0]}}]\nobstacle: [{posts}]\n"
    material = world(text, posts={"role": "obstacle"}, mover={"inside": [0, 4, 2, 6]}, stands={"inside": [0, 0, 2, 2]})
    near = {"of": "mover", **keys}
    assert seen(material, "near", {**near, "distance": {"eq": distance, "tol": 0.01}}).passed
    assert not seen(material, "near", {**near, "distance": {"eq": distance + 0.1, "tol": 0.05}}).passed
    if keys["what"] == "way":
        assert not seen(material, "near", {**near, "of": "stands", "distance": {"ge": 0}}).passed  # it has no goal


@pytest.mark.parametrize(("third", "passes"), [(", goal: [5, 1, 0]", True), (", goal: [8, 1, 0]", False), ("", False)])
def test_goals_are_apart_if_everybody_has_one(third: str, passes: bool) -> None:
    keys = "kinematics: {name: omni}, shape: {name: circle, radius: 0.2}"
    first = [f"{{{keys}, state: [{x}, 8, 0], goal: [{x}, 1, 0]}}" for x in (1, 9)]
    text = f"world: {{width: 10, height: 10}}\nrobot: [{', '.join(first)}, {{{keys}, state: [5, 8, 0]{third}}}]\n"
    assert seen(world(text), "spacing", {"of": "robots", "what": "goal", "distance": {"ge": 2}}).passed == passes
