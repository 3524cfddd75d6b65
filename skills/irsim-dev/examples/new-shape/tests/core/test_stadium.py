"""`stadium` touches with its round ends, not with the corners of a rectangle."""

from __future__ import annotations

import pytest

import irsim

SCENE = """
robot: {{kinematics: {{name: diff}}, shape: {{name: stadium, length: 1.0, width: 0.4}}, state: [2, 2, 0], goal: [8, 2]}}
obstacle: {{shape: {{name: circle, radius: 0.1}}, state: [{x}, {y}]}}
"""


@pytest.mark.parametrize(
    ("x", "y", "touches"),
    [
        (2.79, 2.0, True),  # 0.5 + 0.2 + 0.1 ahead of the middle
        (2.81, 2.0, False),
        (2.0, 2.29, True),  # at the side
        (2.0, 2.31, False),
        (2.72, 2.22, False),  # beside the round end: a rectangle of 1.4 m would touch
    ],
)
def test_contact(tmp_path, x: float, y: float, touches: bool) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE.format(x=x, y=y), encoding="utf-8")
    env = irsim.make(path, headless=True, log_level="ERROR")
    assert env.robot.collision is touches
    env.end()
