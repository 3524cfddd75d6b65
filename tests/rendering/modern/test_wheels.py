"""Wheels of drives that steer: four of a car, three of a tricycle, turned by the steering angle."""

from __future__ import annotations

import pytest

from tests.rendering.modern.conftest import Opened, picture_of

WORLD = """
world: {width: 8, height: 8}
robot: {kinematics: {name: %s, wheelbase: 1.2}, shape: {name: rectangle, length: 2, width: 1, wheelbase: 1.2},
        state: [3, 4, 0.3, %s], goal: [7, 7]}
"""


def wheels(opened: Opened, drive: str, steer: float) -> list[str]:
    """Outlines of the small marks on the body, as text."""
    scene, _ = picture_of(opened(WORLD % (drive, steer)))
    marks = [mark for mark in scene.all_marks() if mark.object == 0 and mark.part == "arrow"]
    return sorted(repr(mark.geometry) for mark in marks)


@pytest.mark.parametrize(("drive", "count", "steered"), [("acker", 4, 2), ("single_track", 4, 2), ("tricycle", 3, 1)])
def test_steered_wheels_turn(opened: Opened, drive: str, count: int, steered: int) -> None:
    straight, turned = wheels(opened, drive, 0.0), wheels(opened, drive, 0.4)
    other = wheels(opened, "diff", 0.0)
    assert len(straight) == len(turned) == count + len(other)
    assert len(set(straight) - set(turned)) == steered
