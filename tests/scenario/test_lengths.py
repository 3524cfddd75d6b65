"""Lengths in messages of the checker: round numbers stay round, and lengths that differ look different."""

from __future__ import annotations

import irsim
from irsim.common.text import metres

DOOR = """
world: {{width: 10, height: 6, time_limit: 60}}
robot: {{kinematics: {{name: diff}}, shape: {{name: circle, radius: {radius}}}, state: [2, 3, 0], goal: [8, 3],
        behavior: {{name: follow}}}}
obstacle:
  - {{shape: {{name: rectangle, length: 0.3, width: 2.5}}, state: [5, 1.25, 0]}}
  - {{shape: {{name: rectangle, length: 0.3, width: 2.5}}, state: [5, 4.75, 0]}}
"""


def messages(radius: float) -> str:
    return " ".join(f"{item.message} {item.fix}" for item in irsim.validate(text=DOOR.format(radius=radius)).findings)


def test_a_door_of_one_metre_is_one_metre_wide() -> None:
    for radius in (0.45, 0.48, 0.55, 0.7):
        said = messages(radius)
        assert "gap of 1 m" in said, said
        assert "0.99" not in said


def test_lengths_have_centimetres_and_small_ones_two_digits() -> None:
    assert [metres(value) for value in (0.9991, 1.0004, 2.345, 0.0834, 12345.678)] == [
        "1 m",
        "1 m",
        "2.35 m",
        "0.083 m",
        "12345.68 m",
    ]


def test_a_length_beside_a_similar_one_has_the_decimals_that_tell_them_apart() -> None:
    assert metres(0.5991, unlike=0.6) == "0.599 m"
    assert metres(1, unlike=1.2) == "1 m"
    assert metres(1.0, unlike=1.0) == "1 m"
