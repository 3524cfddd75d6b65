"""Predicates about episodes: where bodies come, in which order, when, and how fast."""

from __future__ import annotations

from typing import Any

import pytest

from irsim_evals.grader.episode import run_episode
from irsim_evals.grader.material import Material, with_speeds
from irsim_evals.grader.predicates._base import registered
from tests.evals.conftest import episode, seen, world

DRIVE = "kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, behavior: {name: dash}"
EAST = f"{{{DRIVE}, state: [1, 5, 0], goal: [9, 5, 0]}}"
WEST = f"{{{DRIVE}, state: [9, 5, 0], goal: [1, 5, 0]}}"
NORTH = f"{{{DRIVE}, state: [5, 1, 0], goal: [5, 9, 0]}}"
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


def hall(*robots: str, obstacle: str = "") -> Material:
    text = f"world: {{width: 10, height: 10}}\nrobot: [{', '.join(robots)}]\n"
    return world(text + (f"obstacle: [{obstacle}]\n" if obstacle else ""))


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
    aisle = {"of": "robots", "region": [2, 4, 8, 6], "direction": direction, "number": number}
    observation = seen(hall(robot), "one_way", aisle, 16)
    assert observation.passed == passes
    assert "toward" in observation.expected


@pytest.mark.parametrize(
    ("regions", "avoids", "observed"),
    [
        ([[4, 4, 6, 6], [8, 4, 10, 6]], [], "so it is"),
        ([[8, 4, 10, 6], [4, 4, 6, 6]], [], "does not come to (4, 4, 6, 6) after 1 visits"),
        ([[4, 7, 6, 9]], [], "does not come to (4, 7, 6, 9)"),
        ([[8, 4, 10, 6]], [[4, 4, 6, 6]], "comes to (4, 4, 6, 6)"),
    ],
)
def test_rooms_are_entered_in_their_order(regions: Any, avoids: Any, observed: str) -> None:
    observation = seen(hall(EAST), "visits", {"of": "robots", "places": regions, "avoids": avoids}, 12)
    assert observed in observation.observed
    assert observation.passed == (observed == "so it is")


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
    material = hall(*(robot.replace("radius: 0.2}", "radius: 0.2}, unobstructed: true") for robot in robots))
    table = {"of": "robots", "line": [[5, 0], [5, 10]], "times": times, "tol": 0.2}
    assert seen(material, "crosses", table, 12).passed == passes


@pytest.mark.parametrize(("share", "passes"), [({"ge": 0.3, "le": 0.5}, True), ({"ge": 0.9}, False)])
def test_a_body_ends_on_a_part_of_its_way(share: Any, passes: bool) -> None:
    material = hall(EAST, obstacle="{shape: {name: rectangle, length: 0.2, width: 4}, state: [5, 5, 0]}")
    assert seen(material, "moves", {"of": "robots", "progress": share}, 12).passed == passes


@pytest.mark.parametrize(
    ("keys", "observed"),
    [
        ({}, ""),
        ({"laps": 2, "stray": 0.2}, ""),
        ({"places": [(6, 6), (6, 2), (2, 2)]}, "does not come to (6, 2) after 1 visits"),
        ({"places": [(6, 2), (2, 6)]}, "does not come to (2, 6)"),
        ({"laps": 9}, "does not come to"),
        ({"places": [(6, 2), (2, 2)], "stray": 0.5}, "off the lines"),
        ({"of": "missing"}, "no body"),
    ],
)
def test_a_round_is_followed_in_its_order(keys: dict[str, Any], observed: str) -> None:
    material = world(ROUND, guard={"named": "guard"}, missing={"named": "missing"})
    seconds = 15 if "places" in keys and "stray" not in keys else 32
    observation = seen(material, "visits", {"of": "guard", "places": [(6, 2), (6, 6), (2, 2)], **keys}, seconds)
    assert observation.passed == (observed == "")
    assert observed in observation.observed


def test_an_episode_may_have_other_speed_limits() -> None:
    material = hall(EAST, NORTH)
    assert material.scenario is not None
    slow = run_episode(with_speeds(material.scenario, material, 0, {"robots": 0.5}), 0, 2)
    fast = episode(material, 2)
    assert slow.positions(0)[-1][0] - 1 == pytest.approx((fast.positions(0)[-1][0] - 1) / 2, abs=0.05)
    assert material.scenario.objects[0].vel_max[0] == 1


@pytest.mark.parametrize(
    ("behavior", "share", "passes"),
    [("{name: dash, loop: true}", 0, True), ("{name: dash}", 0, False), ("{name: dash}", 1, True)],
)
def test_who_goes_round_for_ever_never_arrives_for_good(behavior: str, share: int, passes: bool) -> None:
    robot = f"{{kinematics: {{name: omni}}, state: [1, 5], goal: [4, 5], behavior: {behavior}}}"
    material = world(f"robot: {robot}")
    assert seen(material, "arrive", {"of": "robots", "share": 1}, 8).passed
    assert seen(material, "arrive", {"of": "robots", "share": share, "for_good": True}, 8).passed == passes


@pytest.mark.parametrize(
    ("robots", "keys", "passes"),
    [
        (
            [EAST],
            {"number": 1, "direction": "left_to_right"},
            True,
        ),
        ([EAST], {"number": 1, "direction": "right_to_left"}, False),
        ([WEST], {"number": 1, "direction": "right_to_left"}, True),
        ([EAST, NORTH], {"number": 1}, True),
        ([EAST], {"number": 2}, False),
        ([EAST], {"number": 1, "line": [[5, 6], [5, 9]]}, False),  # passes beside the end of the line
        (
            [EAST, NORTH.replace("1, 0]", "3, 0]")],
            {"number": 1, "line": None, "way_of": "north", "direction": "left_to_right"},
            False,
        ),  # behind it
        (
            [EAST, NORTH],
            {"number": 1, "line": None, "way_of": "north", "direction": "left_to_right", "ahead": False},
            True,
        ),
        ([EAST], {"number": 1, "line": None, "way_of": "missing"}, False),
    ],
)
def test_a_line_is_crossed_in_a_direction(robots: list[str], keys: dict[str, Any], passes: bool) -> None:
    text = ", ".join(robot.replace("0.2}", "0.2}, unobstructed: true") for robot in robots)
    ways = {"north": {"inside": [4, 0, 6, 4]}, "missing": {"named": "missing"}}
    material = world(f"world: {{width: 10, height: 10}}\nrobot: [{text}]\n", **ways)
    line = {"of": "robots", "line": [[5, 4], [5, 6]], **keys}
    assert seen(material, "crosses", line, 12).passed == passes


@pytest.mark.parametrize(
    "keys", [{"number": 1}, {"line": [[0, 0], [1, 1]]}, {"line": [[0, 0], [1, 1]], "way_of": "all"}]
)
def test_a_crossing_needs_one_line_and_a_number(keys: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"give either|say how many"):
        registered()["crosses"].model_validate({"of": "robots", **keys})


def among(robot: str, *places: tuple[float, float]) -> Material:
    """A robot in a hall with people who stand."""
    shape = "shape: {name: circle, radius: 0.3}"
    people = [f"{{name: person-{k}, {shape}, state: [{x}, {y}, 0]}}" for k, (x, y) in enumerate(places)]
    text = f"world: {{width: 10, height: 10}}\nrobot: [{robot}]\nobstacle: [{', '.join(people)}]\n"
    return world(text, missing={"named": "missing"}, persons={"named": "person"})


@pytest.mark.parametrize(
    ("places", "hull", "distance"),
    [
        ([(5, 3), (5, 7)], False, 1.5),  # it goes through the middle
        ([(5, 3), (5, 7)], True, 0),
        ([(5, 3), (5, 4), (6, 3.5)], False, 0.5),  # it goes past all of them
        ([(5, 3), (5, 4), (6, 3.5)], True, 0.5),
        ([(4, 6.5), (6, 6.5)], True, 1),
    ],
)
def test_who_goes_round_a_group_stays_out_of_its_hull(places: Any, hull: bool, distance: float) -> None:
    keys = {"of": "robots", "to": "persons", "hull": hull, "distance": {"eq": distance, "tol": 0.02}}
    assert seen(among(EAST, *places), "separation", keys, 12).passed
    keys["distance"] = {"ge": distance + 0.1}
    assert not seen(among(EAST, *places), "separation", keys, 12).passed
    keys["to"] = "missing"
    assert not seen(among(EAST, *places), "separation", keys, 12).passed


def test_a_hull_is_that_of_the_moment() -> None:
    walkers = [f"{{name: person-{x}, {DRIVE}, state: [{x}, 9, 0], goal: [{x}, 1, 0]}}" for x in (4, 7)]
    late = f"{{name: person-late, {DRIVE}, state: [1, 5.9, 0], appear_time: 30}}"
    material = world(
        f"world: {{width: 10, height: 10}}\nrobot: [{EAST}]\nobstacle: [{', '.join([*walkers, late])}]\n",
        persons={"named": "person"},
    )
    keys = {"of": "robots", "to": "persons", "hull": True}  # after 4 s all of them are at y = 5
    assert seen(material, "separation", {**keys, "distance": 0}, 5).passed
    assert seen(material, "separation", {**keys, "distance": {"eq": 1.84, "tol": 0.02}}, 2).passed


POSTS = [(3, 5), (5, 5), (7, 5)]


@pytest.mark.parametrize(
    ("way", "posts", "sides"),
    [
        ([(3, 6), (5, 4), (7, 6), (9, 5)], POSTS, {"alternating"}),
        ([(3, 6), (5, 6), (7, 6), (9, 5)], POSTS, {"right", "same"}),
        ([(3, 4), (5, 4), (7, 4), (9, 5)], POSTS, {"left", "same"}),
        ([(3, 4), (5, 4), (7, 6), (9, 5)], POSTS, set()),  # the first two on the same side, the third on the other
        ([(3, 6), (5, 4), (6.2, 5)], POSTS, set()),  # ends before the last one
        ([(3, 6), (9, 6), (9, 2), (1, 2)], POSTS, {"right", "same"}),  # and once more from farther away
        ([(3, 6), (9, 6)], [(3, 5)], {"right", "same"}),  # a single one does not alternate
        ([(9, 5)], [(0.4, 5)], set()),  # behind it from the start
        ([(9, 5)], [], set()),
    ],
)
def test_a_body_passes_others_on_one_side(way: Any, posts: Any, sides: set[str]) -> None:
    robot = f"{{{DRIVE}, state: [1, 5, 0], waypoints: {[list(point) for point in way]}}}"
    observed = {
        side: seen(among(robot, *posts), "passes", {"of": "robots", "by": "persons", "side": side}, 22)
        for side in ("left", "right", "same", "alternating")
    }
    assert {side for side, observation in observed.items() if observation.passed} == sides, observed["left"].observed


@pytest.mark.parametrize(("x", "passes"), [(5, True), (12, False)])
def test_a_wall_is_passed_at_its_end(x: float, passes: bool) -> None:
    wall = f"{{name: wall, shape: {{name: linestring, vertices: [[{x}, 0], [{x}, 4.5]]}}, state: [0, 0, 0]}}"
    keys = {"of": "robots", "by": "statics", "side": "right"}
    text = f"world: {{width: 15, height: 10}}\nrobot: [{EAST}]\nobstacle: [{wall}]\n"
    assert seen(world(text), "passes", keys, 12).passed == passes


def test_who_comes_the_other_way_is_passed() -> None:
    oncoming = f"{{name: person, {DRIVE}, state: [9, 5.8, 0], goal: [1, 5.8, 0]}}"
    material = world(f"world: {{width: 10, height: 10}}\nrobot: [{EAST}]\nobstacle: [{oncoming}]\n")
    assert seen(material, "passes", {"of": "robots", "by": "obstacles", "side": "left"}, 12).passed
    assert seen(material, "passes", {"of": "obstacles", "by": "robots", "side": "left"}, 12).passed
    assert not seen(material, "passes", {"of": "robots", "by": "obstacles", "side": "right"}, 12).passed
    assert not seen(material, "passes", {"of": "solids", "by": "robots", "side": "left"}, 12).passed
