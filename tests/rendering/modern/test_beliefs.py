"""Pictures show where robots that decide from an estimate believe to be."""

from __future__ import annotations

import numpy as np
import pytest

from irsim.graphics.scene.scene import Circle, Line, Region
from irsim.rendering.modern import style
from tests.rendering.modern.conftest import Opened, marks_of, opened, picture_of, pixels_of, take
from tests.runs.replay.beliefs import SCENE

__all__ = ["opened"]
ROUND = SCENE.replace("shape: {name: rectangle, length: 0.6, width: 0.4}", "shape: {name: circle, radius: 0.3}")
ROUND = "\n".join(line for line in ROUND.splitlines() if "localization" not in line)


def test_a_dashed_outline_is_where_the_robot_believes_to_be(opened: Opened, monkeypatch: pytest.MonkeyPatch) -> None:
    env = opened(SCENE)
    take(env, 20)
    robot, read = env.robot_list[0], env.robot_list[0].sensors[1].read()
    joint, outline = marks_of(picture_of(env, 900)[0], "belief")
    assert isinstance(joint.geometry, Line)
    np.testing.assert_allclose(joint.geometry.points, [robot.state[:2, 0], [read["x"], read["y"]]])
    assert isinstance(outline.geometry, Region)
    corners = outline.geometry.rings[0]
    ahead = np.array([np.cos(read["theta"]), np.sin(read["theta"])])
    assert np.ptp(corners @ ahead) == pytest.approx(0.6)
    assert (corners.min(axis=0) + corners.max(axis=0)) / 2 == pytest.approx([read["x"], read["y"]])
    assert outline.fill is None
    assert outline.stroke.style == (0, (4, 3))
    shown, _ = pixels_of(env, 700)
    monkeypatch.setattr(style, "belief_marks", lambda *_: [])
    assert (shown != pixels_of(env, 700)[0]).any(axis=2).sum() > 100
    env.end(0)
    sure = opened(SCENE.replace("perceives: both", "perceives: truth"))
    take(sure, 20)
    assert marks_of(picture_of(sure, 900)[0], "belief") == []
    sure.end(0)


def test_a_belief_at_the_true_place_has_no_line(opened: Opened) -> None:
    env = opened(ROUND)
    [outline] = marks_of(picture_of(env, 900)[0], "belief")
    env.end(0)
    assert isinstance(outline.geometry, Circle)
    assert (outline.geometry.x, outline.geometry.y, outline.geometry.radius) == (1, 2, pytest.approx(0.3))
