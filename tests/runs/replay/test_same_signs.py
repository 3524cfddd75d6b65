"""Robots have the same colours and darts on the replay page and in pictures of the same run."""

from __future__ import annotations

from typing import Any

import pytest

import irsim
from irsim.graphics.scene.theme import THEMES
from irsim.objects.describe import describe_scene
from irsim.options.colors import CYCLE, ROBOT_COLOR
from irsim.runs.replay.drawing import page_objects
from tests.rendering.modern.conftest import Opened, labels_of, marks_of, opened, picture_of, take

__all__ = ["opened"]

WORLD = """\
world: {width: 12, height: 12}
robot:
"""
CIRCLE = """\
  - number: NUMBER
    kinematics: {name: omni}
    behavior: {name: dash}
    distribution: {name: circle, radius: 4.5, center: [6, 6, 0]}
    shape: {name: circle, radius: 0.25}
"""
LONE = """\
  - {kinematics: {name: diff}, state: [1, PLACE, 0], goal: [9, PLACE, 0], shape: {name: circle, radius: 0.3}, MORE}
"""


def circle(number: int, *more: str) -> str:
    lone = "".join(
        LONE.replace("PLACE", str(place)).replace(", MORE", f", {keys}" if keys else "")
        for place, keys in enumerate(more, 1)
    )
    return WORLD + (CIRCLE.replace("NUMBER", str(number)) if number else "") + lone


def robots_of(env: irsim.Env) -> list[dict[str, Any]]:
    """Robots as the page has them."""
    return [one for one in page_objects(describe_scene(env.simulation))[1] if one["role"] == "robot"]


CHOSEN = "color: '#0072B2'", "plot: {obj_color: '#CC79A7'}"


@pytest.mark.parametrize("theme", list(THEMES))
@pytest.mark.parametrize("text", [circle(2), circle(6), circle(13), circle(2, *CHOSEN)], ids=["2", "6", "13", "own"])
def test_a_robot_and_its_goal_have_the_colour_that_pictures_give_them(opened: Opened, text: str, theme: str) -> None:
    env = opened(text, theme)
    take(env, 1)
    scene, _ = picture_of(env, 900)
    fills = {mark.object: mark.fill for mark in marks_of(scene, "body")}
    goals = {mark.object: mark.stroke.color for mark in marks_of(scene, "goal") if mark.stroke.color}
    names = {label.object: label.color for label in labels_of(scene, "name")}
    robots = robots_of(env)
    for view, robot in zip(env.robot_list, robots, strict=True):
        fill, edge, name, _ = robot["shades"][theme]
        assert (fill, edge) == (fills[view.id], goals[view.id]), robot["name"]
        assert names.get(view.id, name) == name
    assert len({robot["shades"][theme][0] for robot in robots}) == (1 if len(robots) > 6 else len(robots))


def test_chosen_colours_are_given_to_no_other_robot(opened: Opened) -> None:
    fills = [robot["shades"]["light"][0].lower() for robot in robots_of(opened(circle(2, *CHOSEN)))]
    assert fills == [one.lower() for one in (CYCLE[0], CYCLE[2], "#0072B2", "#CC79A7")]


def test_colours_do_not_change_when_robots_come(opened: Opened) -> None:
    env = opened(circle(0, "appear_time: 0.5", ""))
    before, drawn = robots_of(env), list[dict[int, Any]]()
    for _ in range(3):  # the first one is shown as a ghost at the start, then not at all, then as it is
        drawn.append({mark.object: mark.fill for mark in marks_of(picture_of(env)[0], "body")})
        take(env, 4)
    late, other = (view.id for view in env.robot_list)
    assert [len(fills) for fills in drawn] == [2, 1, 2]
    assert {fills[other] for fills in drawn} == {before[1]["shades"]["light"][0]}
    assert drawn[2][late] == before[0]["shades"]["light"][0] != drawn[2][other]
    assert before == robots_of(env)


def test_one_robot_alone_has_the_usual_colour(opened: Opened) -> None:
    [robot] = robots_of(opened(circle(0, "")))
    assert robot["shades"]["light"][0].lower() == ROBOT_COLOR.lower()


def test_only_drives_that_never_turn_a_robot_have_a_dart_along_its_motion(opened: Opened) -> None:
    env = opened(circle(2, ""))
    assert [robot["motion"] for robot in robots_of(env)] == [True, True, False]
