"""Sight, places and motion of bodies, measured in scenes whose numbers follow from arithmetic."""

from __future__ import annotations

from typing import Any

import pytest

from irsim_evals.grader.artefact import Answer
from irsim_evals.grader.grade import grade
from irsim_evals.grader.material import Material
from tests.evals.conftest import failed, made_up, seen, world

OMNI = "kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, behavior: {name: dash}, vel_max: [1, 1]"
DIFF = "kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, behavior: {name: dash}, vel_max: [1, 1]"
LIDAR = "sensors: [{name: lidar2d, range_max: 3, angle_range: 1.5708, number: 31}]"
WATCH = {"watch": {"named": "watch"}, "one": {"named": "one"}, "two": {"named": "two"}, "missing": {"named": "missing"}}


def hall(watcher: str, *others: str, static: str = "") -> Material:
    """A watcher at (1, 5) that stands and looks to the right, and others."""
    robots = [f"{{name: watch, {watcher}}}", *(f"{{{other}}}" for other in others)]
    text = f"world: {{width: 12, height: 10}}\nrobot: [{', '.join(robots)}]\n"
    return world(text + (f"obstacle: [{{{static}}}]\n" if static else ""), **WATCH)


def crossing(name: str, x: float, radius: float = 0.2) -> str:
    """A body that goes up at 1 m/s past x, from y = 0 on."""
    return f"name: {name}, {OMNI.replace('0.2', str(radius))}, state: [{x}, 0, 0], goal: [{x}, 10, 0]"


STANDS = "kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [1, 5, 0]"
CONE = f"{STANDS}, fov: 1.5707963, fov_radius: 3"


@pytest.mark.parametrize(
    ("keys", "passes"),
    [
        ({}, True),
        ({"what": "one", "number": 1}, True),
        ({"what": "two", "number": 1}, False),  # passes beyond the range
        ({"what": "two", "number": 0}, True),
        ({"what": "missing", "number": 0}, False),  # no object has this name
        ({"what": "one", "by": "fov"}, True),
        ({"what": "one", "by": "lidar2d"}, False),
        # the edge of the cone at x = 3 is 2 m below the watcher; the disc reaches it at y = 3 - 0.2 * sqrt(2)
        ({"what": "one", "first": {"eq": 2.7, "tol": 0.11}}, True),
        ({"what": "one", "first": {"le": 2.5}}, False),
        ({"what": "two", "first": {"given": False}}, True),
        ({"what": "one", "first": {"given": False}}, False),
        ({"what": "one", "seconds": {"eq": 4.57, "tol": 0.11}}, True),
        ({"what": "one", "seconds": {"le": 4}}, False),
        ({"what": "one", "until": 2.5}, False),
        ({"what": "one", "until": 2.5, "number": 0}, True),
        ({"what": "one", "since": 3, "until": 4, "seconds": {"eq": 1.1, "tol": 0.01}}, True),
        ({"what": "one", "since": -0.01, "number": 0}, True),  # at the end it is gone
        ({"what": "one", "since": -0.01}, False),
        ({"of": "two"}, False),  # has no sensor
        ({"of": "missing"}, False),
    ],
)
def test_a_field_of_view_is_passed_in_time(keys: dict[str, Any], passes: bool) -> None:
    material = hall(CONE, crossing("one", 3), crossing("two", 5))
    assert seen(material, "sees", {"of": "watch", **keys}, 9).passed == passes


@pytest.mark.parametrize(
    ("place", "keys", "passes"),
    [
        # the beams are 3° apart; a disc of radius 0.5 at 2 m covers asin(0.25) = 14.5° to each side: 9 beams
        ([3, 5, 0], {"what": "one", "beams": 9}, True),
        ([3, 5, 0], {"what": "one", "beams": 10}, False),
        ([3, 5, 0], {"beams": 9}, True),
        ([3, 5, 0], {"what": "one", "number": 1}, True),
        ([6, 5, 0], {"what": "one", "number": 1}, False),  # out of range
        ([1, 8, 0], {"what": "one", "number": 1}, False),  # beside it
        ([3, 5, 0], {"what": "one", "seconds": {"ge": 0.1}}, False),  # no time has passed
        ([3, 5, 0], {"what": "one", "first": 0}, True),
        ([3, 5, 0], {"what": "one", "radial": {"le": -0.1}}, False),  # measures no velocities
    ],
)
def test_a_lidar_sees_at_the_start_who_is_in_front_of_it(
    place: list[float], keys: dict[str, Any], passes: bool
) -> None:
    one = f"name: one, shape: {{name: circle, radius: 0.5}}, state: {place}"
    material = hall(f"{STANDS}, {LIDAR}", static=one)
    assert seen(material, "sees", {"of": "watch", **keys}).passed == passes


def test_a_lidar_does_not_see_through_a_wall() -> None:
    wall = "name: two, shape: {name: rectangle, length: 0.2, width: 8}, state: [2, 5, 0]"
    material = hall(
        f"{STANDS}, {LIDAR}", "name: one, shape: {name: circle, radius: 0.5}, state: [3, 5, 0]", static=wall
    )
    assert not seen(material, "sees", {"of": "watch", "what": "one"}).passed
    assert seen(material, "sees", {"of": "watch", "what": "two"}).passed


@pytest.mark.parametrize(
    ("goal", "keys", "passes"),
    [
        ([1.9, 5, 0], {"radial": {"le": -0.9}}, True),
        ([1.9, 5, 0], {"radial": {"ge": 0.1}}, False),
        ([9, 5, 0], {"radial": {"ge": 0.9}}, True),
        ([9, 5, 0], {"radial": {"ge": 1.1}}, False),
        ([9, 5, 0], {"radial": {"ge": 0.9}, "beams": {"ge": 60}}, False),
    ],
)
def test_beams_tell_what_comes_nearer(goal: list[float], keys: dict[str, Any], passes: bool) -> None:
    radar = f"{STANDS}, {LIDAR.replace('lidar2d', 'fmcw_lidar2d')}"
    material = hall(radar, f"name: one, {OMNI}, state: [3, 5, 0], goal: {goal}")
    assert seen(material, "sees", {"of": "watch", "what": "one", **keys}, 0.5).passed == passes


def test_assertions_about_the_start_may_be_about_what_is_seen() -> None:
    one = "{shape: {name: circle, radius: 0.5}, state: [%s, 5, 0]}"
    text = f"world: {{width: 12, height: 10}}\nrobot: [{{{STANDS}, {LIDAR}}}]\nobstacle: [{one}]\n"
    case = made_up({"id": "sees", "sees": {"of": "robots", "what": "obstacles"}})
    near, far = (grade(case, Answer("x", {"scenario.yaml": text % x})) for x in (3, 8))
    assert (failed(near), failed(far)) == ([], ["sees"])


@pytest.mark.parametrize(
    ("robot", "keys", "passes"),
    [
        (f"{OMNI}, state: [1, 5, 0], goal: [9, 5, 0]", {"at": 3, "x": 4, "y": 5, "heading": 0, "speed": 1}, True),
        (f"{OMNI}, state: [1, 5, 0], goal: [9, 5, 0]", {"at": 3, "x": 5}, False),
        (f"{OMNI}, state: [1, 5, 0], goal: [9, 5, 0]", {"at": 3, "speed": 0.5}, False),
        (f"{OMNI}, state: [1, 5, 0], goal: [9, 5, 0]", {"at": -2, "x": 4, "goal_distance": 5}, True),
        (f"{OMNI}, state: [1, 5, 0], goal: [9, 5, 0]", {"at": 3, "heading": "90deg"}, False),
        (f"{OMNI}, state: [1, 5, 0], goal: [9, 5, 0]", {"at": 9, "x": {"ge": 0}}, False),  # after the end
        (f"{OMNI}, state: [1, 5, 0], goal: [9, 5, 0]", {"at": 0, "x": 1}, True),
        (f"{OMNI}, state: [1, 5, 0], goal: [9, 5, 0]", {"at": 0, "speed": {"ge": 0}}, False),  # no speed at the start
        # turns to the left at 1 rad/s first: its goal is behind it
        (f"{DIFF}, state: [5, 5, 0], goal: [1, 5.01, 0]", {"at": 1, "heading": 1.0, "turn": 1}, True),
        (f"{DIFF}, state: [5, 5, 0], goal: [1, 4.99, 0]", {"at": 1, "heading": -1.0, "turn": -1}, True),
        (f"{DIFF}, state: [5, 5, 0], goal: [1, 4.99, 0]", {"at": 1, "turn": 1}, False),
    ],
)
def test_a_body_is_somewhere_at_a_time(robot: str, keys: dict[str, Any], passes: bool) -> None:
    assert seen(hall(robot), "state_at", {"of": "watch", **keys}, 5).passed == passes


def test_the_state_at_a_time_is_that_without_noise() -> None:
    noisy = OMNI.replace("{name: omni}", "{name: omni, noise: true, alpha: [0.5, 0.5, 0.5, 0.5]}")
    text = f"world: {{width: 12, height: 10}}\nrobot: [{{{noisy}, state: [1, 5, 0], goal: [9, 5, 0]}}]\n"
    place = {"of": "robots", "at": 3, "x": {"eq": 4, "tol": 0.001}, "y": {"eq": 5, "tol": 0.001}}
    stays = {"of": "robots", "dy": {"eq": 0, "tol": 0.001}}
    plan = {"seconds": 4, "assert": [{"id": "place", "state_at": place}, {"id": "drift", "moves": stays}]}
    assert failed(grade(made_up(episodes=[plan]), Answer("x", {"scenario.yaml": text}))) == ["drift"]


@pytest.mark.parametrize(
    ("keys", "passes"),
    [
        ({"path": 4, "farthest": 4, "dx": 4, "dy": 0, "progress": 0.5}, True),
        ({"progress": 0.6}, False),
        ({"fastest": 1, "slowest": 1, "turn": 0}, True),
        ({"fastest": 0.9}, False),
        ({"since": 3, "path": 1}, True),
        ({"since": -1, "farthest": 1}, True),
        ({"since": 3, "path": 4}, False),
        ({"since": -1, "progress": 0.5}, True),
    ],
)
def test_motion_is_measured_over_a_part_of_an_episode(keys: dict[str, Any], passes: bool) -> None:
    material = hall(f"{OMNI}, state: [1, 5, 0], goal: [9, 5, 0]")
    assert seen(material, "moves", {"of": "watch", **keys}, 4).passed == passes


@pytest.mark.parametrize(
    ("robot", "name", "keys", "passes"),
    [
        ("appear_time: 2", "moves", {"path": {"eq": 2, "tol": 0.2}, "fastest": 1, "farthest": {"ge": 1.8}}, True),
        ("appear_time: 2", "moves", {"fastest": {"ge": 1.1}}, False),
        ("appear_time: 2", "moves", {"since": 3, "path": 1}, True),
        ("appear_time: 9", "moves", {"path": {"ge": 0}}, False),  # has not come by the end
        ("appear_time: 2", "state_at", {"at": 3, "x": {"eq": 2, "tol": 0.2}, "speed": 1}, True),
        ("appear_time: 2", "state_at", {"at": 1, "x": {"ge": 0}}, False),
        ("appear_time: 2", "state_at", {"at": 1, "x": {"given": False}}, True),
        ("appear_time: 2", "roams", {"share": 0.0, "endless": False}, True),
        ("appear_time: 9", "roams", {"share": 0.0, "endless": False}, False),
    ],
)
def test_motion_of_who_comes_later(robot: str, name: str, keys: dict[str, Any], passes: bool) -> None:
    material = hall(f"{OMNI}, state: [1, 5, 0], goal: [9, 5, 0], {robot}")
    assert seen(material, name, {"of": "watch", **keys}, 4).passed == passes


def test_who_comes_and_stays_where_it_is_does_not_move() -> None:
    late = "kinematics: {name: omni}, behavior: {name: dash}, appear_time: 1, vel_max: [0, 0]"
    text = f"world: {{width: 12, height: 10}}\nrobot: [{{{late}, state: [1, 5, 0], goal: [9, 5, 0]}}]\n"
    assert "moves" in failed(grade(made_up(), Answer("x", {"scenario.yaml": text})))


@pytest.mark.parametrize(("in_vain", "wrong"), [(False, ["goals-count"]), (True, [])])
def test_a_time_limit_that_nobody_can_meet_is_wrong_unless_the_case_is_about_one(
    in_vain: bool, wrong: list[str]
) -> None:
    text = f"world: {{width: 12, height: 10, time_limit: 3}}\nrobot: [{{{OMNI}, state: [1, 5, 0], goal: [9, 5, 0]}}]\n"
    assert failed(grade(made_up(in_vain=in_vain), Answer("x", {"scenario.yaml": text}))) == wrong


def test_the_goal_of_a_replay_is_the_end_of_the_recording() -> None:
    replay = "behavior: {name: replay, times: [0, 5], poses: [[3, 1, 0], [8, 1, 0]]}"
    material = hall(STANDS, f"name: one, kinematics: {{name: omni}}, {replay}, state: [3, 1, 0]")
    assert seen(material, "each", {"of": "one", "has": {"goal_x": 8, "goals": 1}}).passed
    assert seen(material, "arrive", {"of": "one"}, 6).passed


@pytest.mark.parametrize(
    ("robot", "keys", "passes"),
    [
        ("state: [1, 5, 0], goal: [5, 5, 0]", {"standstill": 0}, True),  # it has arrived after 4 s
        ("state: [1, 5, 0], goal: [5, 5, 0]", {"standstill": {"ge": 1}}, False),
        ("state: [1, 5, 0], goal: [5, 5, 0], start_time: 3", {"standstill": {"eq": 3, "tol": 0.11}}, True),
        ("state: [1, 5, 0], goal: [5, 5, 0], start_time: 3", {"since": 1, "standstill": {"eq": 2, "tol": 0.11}}, True),
        ("state: [1, 5, 0], goal: [5, 5, 0], appear_time: 3", {"standstill": 0}, True),
        ("state: [1, 5, 0], goal: [9, 5, 0]", {"standstill": 0}, True),
    ],
)
def test_a_standstill_ends_with_the_arrival(robot: str, keys: dict[str, Any], passes: bool) -> None:
    assert seen(hall(f"{OMNI}, {robot}"), "moves", {"of": "watch", **keys}, 8).passed == passes


@pytest.mark.parametrize(
    ("keys", "passes"),
    [
        ({"at": 0, "to": "one", "distance": {"eq": 1.6, "tol": 0.01}}, True),
        ({"at": 1, "to": "one", "distance": {"eq": 0.6, "tol": 0.01}}, True),
        ({"at": 1, "to": "one", "distance": {"ge": 1}}, False),
        ({"at": 1, "to": "all", "distance": {"eq": 0.6, "tol": 0.01}}, True),  # to the nearest of the others
        ({"at": 1, "to": "two", "distance": {"ge": 0.5}}, False),  # has not come by then
        ({"at": 1, "to": "two", "distance": {"given": False}}, True),
        ({"at": 1, "to": "missing", "distance": {"ge": 0}}, False),
        ({"at": 1, "to": "watch", "distance": {"ge": 0}}, False),  # there is no other body in it
    ],
)
def test_others_are_so_far_away_at_a_time(keys: dict[str, Any], passes: bool) -> None:
    robot = f"{OMNI}, state: [1, 5, 0], goal: [9, 5, 0]"
    box = "name: one, shape: {name: rectangle, length: 0.4, width: 2}, state: [3, 5, 0]"
    material = hall(robot, f"name: two, {OMNI}, state: [1, 8, 0], goal: [9, 8, 0], appear_time: 5", static=box)
    assert seen(material, "state_at", {"of": "watch", **keys}, 3).passed == passes


def test_a_distance_at_a_time_is_to_somebody() -> None:
    for keys in ({"to": "one"}, {"distance": 1}):
        with pytest.raises(ValueError, match="give both"):
            seen(hall(CONE), "state_at", {"of": "watch", "at": 1, **keys}, 1)
