"""The style `modern`: robots are told apart, and robots that collided are counted."""

from __future__ import annotations

import pytest

import irsim
from irsim.bundled import templates
from tests.rendering.modern.conftest import Opened, labels_of, picture_of, take, words_of


def test_the_title_counts_the_robots_that_collided_as_the_reason_does(opened: Opened) -> None:
    """Two contacts, in which three robots collide."""
    text = """
world: {width: 10, height: 6}
robot:
  - {kinematics: {name: diff}, state: [2, 3, 0], goal: [8, 3], behavior: {name: dash}}
  - {kinematics: {name: diff}, state: [8, 3, 3.14159], goal: [2, 3], behavior: {name: dash}}
  - {kinematics: {name: diff}, state: [5, 1, 1.5708], goal: [5, 5], behavior: {name: dash}, vel_max: [0.4, 1]}
"""
    env = opened(text)
    take(env, 100)
    assert sum(event.kind == "collision" for event in env.events) == 2
    scene, _ = picture_of(env)
    assert words_of(scene)["outcome"] == "3 collided"
    assert "all 3 robots collided" in str(irsim.run(text=text).reason)


@pytest.mark.parametrize(("robots", "first"), [(12, "robot_0"), (16, "r0")])
def test_robots_of_one_color_are_told_apart_by_names(opened: Opened, robots: int, first: str) -> None:
    """There are eight colours."""
    env = opened(templates.fill(templates.load("circle-swap"), {"robots": robots}))
    take(env, 30)
    scene, _ = picture_of(env)
    prefix = first.removesuffix("0")
    assert {label.text for label in labels_of(scene, "name")} == {f"{prefix}{number}" for number in range(robots)}
