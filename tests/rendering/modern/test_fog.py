"""Fog in the style `modern`: whether a picture shows things that no sensor has seen."""

from __future__ import annotations

import numpy as np
import pytest

from tests.rendering.modern.conftest import Opened, parts_of, picture_of, pixels_of

ROOM = """
world: {{width: 12, height: 8, step_time: 0.1, fog_map: true, fog_map_resolution: 0.25, plot: {{fog: {fog}}}}}
robot:
  - {{kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.3}}, state: [2, 4, 0], goal: [10, 7],
     sensors: [{{name: lidar2d, range_max: 3, number: 120, angle_range: 6.28}}]}}
obstacle:
  - {{name: seen, shape: {{name: rectangle, length: 1, width: 1}}, state: [4, 4, 0]}}
  - {{name: far, shape: {{name: rectangle, length: 1, width: 1}}, state: [10, 2, 0]}}
  - {{name: walker, kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.3}}, state: [10, 5, 0], goal: [9, 1],
     behavior: {{name: dash}}}}
"""


@pytest.mark.parametrize(("fog", "shown"), [("veil", [True, True, True]), ("hide", [True, False, False])])
def test_a_picture_that_hides_has_no_trace_of_what_nobody_has_seen(opened: Opened, fog: str, shown: list[bool]) -> None:
    env = opened(ROOM.format(fog=fog))
    env.step()
    scene, _ = picture_of(env)
    assert [bool(parts_of(scene, number)) for number in (1, 2, 3)] == shown
    pixels, _ = pixels_of(env)
    elsewhere = opened(ROOM.format(fog=fog).replace("[10, 2, 0]", "[10, 6, 0]").replace("[10, 5, 0]", "[8, 5, 0]"))
    elsewhere.step()
    other, _ = pixels_of(elsewhere)
    assert np.array_equal(pixels, other) == (fog == "hide")


def test_hiding_fog_covers_the_far_side_of_a_body_that_was_seen(opened: Opened) -> None:
    env = opened(ROOM.format(fog="hide"))
    env.step()
    scene, _ = picture_of(env)
    assert scene.fog is not None
    assert (scene.fog.alpha, scene.fog.zorder) == (1.0, 1.55)
    cells = scene.fog.explored
    assert cells[int(3.6 / 0.25), int(4 / 0.25)]  # the near side
    assert not cells[int(4.4 / 0.25), int(4 / 0.25)]
