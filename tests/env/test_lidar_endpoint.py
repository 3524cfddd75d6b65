"""`endpoint` of lidars: n beams over a full turn as n directions."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import irsim

Make = Callable[..., Any]
TEXT = """
world: {{width: 10, height: 10}}
robot: {{kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.2}}, state: [5, 5, 0], goal: [9, 5],
  behavior: {{name: dash}}, sensors: [{{name: {name}, number: {number}, angle_range: {span}{more}}}]}}
obstacle: {{shape: {{name: circle, radius: 1}}, state: [2, 5, 0]}}
"""


def lidar(
    make: Make, number: int, span: float = 6.28318, more: str = ", endpoint: false", name: str = "lidar2d"
) -> Any:
    env = make(TEXT.format(name=name, number=number, span=span, more=more))
    return env, env.robot.lidar


@pytest.mark.parametrize("name", ["lidar2d", "fmcw_lidar2d"])
def test_n_beams_are_n_directions(make: Make, name: str) -> None:
    _env, scanner = lidar(make, 720, 2 * math.pi, name=name)
    angles = np.degrees(scanner.angle_list)
    np.testing.assert_allclose(angles, np.linspace(-180, 180, 720, endpoint=False), atol=1e-9)
    assert scanner.angle_inc == pytest.approx(math.radians(0.5))
    scan = scanner.get_scan()
    assert scan["angle_increment"] == pytest.approx(math.radians(0.5))
    assert scan["angle_max"] == pytest.approx(math.pi - math.radians(0.5))


def test_the_last_beam_does_not_repeat_the_first(make: Make) -> None:
    _env, scanner = lidar(make, 4, 2 * math.pi)
    assert np.degrees(scanner.angle_list).tolist() == pytest.approx([-180, -90, 0, 90])
    assert scanner.range_data.tolist() == pytest.approx([2, 10, 10, 10])
    _env, closed = lidar(make, 4, 2 * math.pi, more="")
    assert np.degrees(closed.angle_list).tolist() == pytest.approx([-180, -60, 60, 180])


def test_the_key_may_be_written_at_run_time(make: Make) -> None:
    _env, scanner = lidar(make, 9, math.pi, more="")
    assert (scanner.endpoint, scanner.angle_max) == (True, pytest.approx(math.pi / 2))
    scanner.endpoint = False
    assert scanner.angle_max == pytest.approx(math.pi / 2 - math.pi / 9)


def test_the_checker_proposes_the_key() -> None:
    text = TEXT.format(name="lidar2d", number=720, span=6.28318, more="")
    (finding,) = [f for f in irsim.validate(text=text).findings if f.code == "lidar-ends-meet"]
    assert finding.fix == "endpoint: false, for 720 directions"
    text = TEXT.format(name="lidar2d", number=720, span=6.28318, more=", endpoint: false")
    assert [f for f in irsim.validate(text=text).findings if f.code == "lidar-ends-meet"] == []
