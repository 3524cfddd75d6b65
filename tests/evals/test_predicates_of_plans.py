"""Predicates about drawings, rounds and stated numbers: worlds that are right, and worlds wrong in one respect."""

from __future__ import annotations

from typing import Any

import pytest

from irsim.scenario.read import read
from irsim.scenario.yaml.document import load_text
from irsim_evals.grader.episode import run_episode
from irsim_evals.grader.material import Material
from irsim_evals.grader.predicates.courses import Visits
from irsim_evals.grader.predicates.reply import States
from irsim_evals.grader.predicates.world import Plan
from irsim_evals.grader.selection import Selector

SKETCH = """
####
#..#
#.##
"""
RING = """
world: {width: 8, height: 6}
obstacle:
  - {shape: {name: rectangle, length: 8, width: 2}, state: [4, 5, 0]}
  - {shape: {name: rectangle, length: 2, width: 4}, state: [1, 2, 0]}
  - {shape: {name: polygon, vertices: [[4, 0], [8, 0], [8, 4], [6, 4], [6, 2], [4, 2]]}, state: [0, 0, 0]}
"""
ROUND = """
world: {width: 10, height: 10}
obstacle:
  - name: guard
    kinematics: {name: omni}
    shape: {name: circle, radius: 0.3}
    state: [2, 2, 0]
    waypoints: [[6, 2], [6, 6], [2, 2]]
    behavior: {name: dash, loop: true}
"""


def opened(text: str, reply: str = "", **selectors: Any) -> Material:
    reading = read(load_text(text))
    return Material(
        scenario=reading.scenario,
        selectors={name: Selector.model_validate(value) for name, value in selectors.items()},
        texts={},
        reply=reply,
    )


@pytest.mark.parametrize(
    ("text", "observed"),
    [
        (RING, "as in the drawing"),
        (RING.replace("[4, 5, 0]", "[4, 5.05, 0]"), "as in the drawing"),  # within the tolerance
        (RING.replace("length: 8, width: 2}, state: [4, 5, 0]", "length: 7, width: 2}, state: [3.5, 5, 0]"), "missing"),
        (RING.replace("state: [1, 2, 0]", "state: [2, 2, 0]"), "missing"),
        (RING.replace("length: 2, width: 4}, state: [1", "length: 3, width: 4}, state: [1.5"), "too much"),
        (RING + "  - {shape: {name: linestring, vertices: [[2.5, 1], [3.5, 3]]}, state: [0, 0, 0]}\n", "too much"),
        (RING.replace("state: [4, 5, 0]", "state: [4, 5, 0], unobstructed: true"), "missing"),
    ],
)
def test_what_is_solid_agrees_with_a_sketch(text: str, observed: str) -> None:
    material = opened(text)
    seen = Plan(sketch=SKETCH, cell=(2, 2), tol=0.1).observe(material, material.scene(0))
    assert seen.observed.startswith(observed)
    assert seen.passed == (observed == "as in the drawing")
    assert bool(seen.marks) != seen.passed


def test_walls_round_the_world_are_no_surplus() -> None:
    text = RING.replace("height: 6}", "height: 6, boundary: walls}")
    material = opened(text)
    assert Plan(sketch=SKETCH, cell=(2, 2), tol=0.1).observe(material, material.scene(0)).passed


def test_boxes_and_discs_of_a_plan_and_what_it_ignores() -> None:
    material = opened(
        "world: {width: 9, height: 9}\nobstacle:\n"
        "  - {shape: {name: circle, radius: 0.5}, state: [2, 2, 0]}\n"
        "  - {shape: {name: rectangle, length: 2, width: 1}, state: [6, 6, 0]}\n"
    )
    scene = material.scene(0)
    assert Plan(discs=[(2, 2, 0.5)], boxes=[(5, 5.5, 7, 6.5)], tol=0.05).observe(material, scene).passed
    assert not Plan(discs=[(2, 2, 0.7)], boxes=[(5, 5.5, 7, 6.5)], tol=0.05).observe(material, scene).passed
    assert Plan(discs=[(2, 2, 0.7)], boxes=[(5, 5.5, 7, 6.5)], ignore=[(1, 1, 3, 3)]).observe(material, scene).passed
    assert not Plan().observe(material, scene).passed  # a plan of nothing fulfils nothing


@pytest.mark.parametrize(
    ("options", "observed"),
    [
        ({}, ""),
        ({"laps": 2, "stray": 0.2}, ""),
        ({"places": [(6, 6), (6, 2), (2, 2)]}, "does not come to (6, 2) after 1 visits"),
        ({"places": [(6, 2), (2, 6)]}, "does not come to (2, 6)"),
        ({"laps": 9}, "does not come to"),
        ({"places": [(6, 2), (2, 2)], "stray": 0.5}, "off the lines"),
        ({"of": "nobody"}, "no body"),
    ],
)
def test_a_round_is_followed_in_its_order(options: dict[str, Any], observed: str) -> None:
    material = opened(ROUND, guard={"named": "guard"}, nobody={"named": "nobody"})
    assert material.scenario is not None
    episode = run_episode(material.scenario, 0, 15 if "places" in options and "stray" not in options else 32)
    asked = {"of": "guard", "places": [(6, 2), (6, 6), (2, 2)], **options}
    seen = Visits.model_validate(asked).observe(material, episode)
    assert seen.passed == (observed == "")
    assert observed in seen.observed


@pytest.mark.parametrize(
    ("reply", "passes"),
    [
        ("I gave the guard a radius of 0.3 m.", True),
        ("Der Wächter (guard) hat 0,6 m Durchmesser.", True),
        ("The guard measures 60 cm.", True),
        ("The guard has a radius of 0.4 m.", False),
        ("The room is large. " + "x" * 200 + " It has 0.3 m of plaster.", False),  # far from any mention of the guard
        ("", False),
    ],
)
def test_a_reply_states_a_number_that_the_world_has(reply: str, passes: bool) -> None:
    material = opened(ROUND, reply, guard={"named": "guard"})
    seen = States(of="guard", property="radius", about="guard", factors=[1, 2]).observe(material)
    assert seen.passed == passes
    assert "0.3" in seen.expected


def test_the_cells_of_a_map_are_filled() -> None:
    scene = opened("world: {width: 12, height: 9, obstacle_map: {name: perlin, resolution: 0.5, seed: 3}}\n").scene(0)
    cells = scene.terrain_views[0].cells.count
    assert cells > 50
    assert scene.solid.area == pytest.approx(cells * 0.25)
