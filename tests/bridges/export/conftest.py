"""Runs to export."""

from __future__ import annotations

import pytest

from irsim.runs import Run
from tests.bridges.scenes import recorded

SENSORS = """[{name: lidar2d, number: 5, range_max: 3, range_min: 0.1, angle_range: 2, offset: [0.2, 0, 0.1]},
      {name: lidar2d, number: 3, range_max: 9}]"""
HALL = f"""\
world: {{width: 12, height: 8, collision_mode: unobstructed}}
robot:
  - {{name: rover 1, kinematics: {{name: diff}}, state: [1, 1, 0.5], goal: [5, 1, 0], behavior: {{name: dash}},
      shape: {{name: circle, radius: 0.2}}, sensors: {SENSORS}}}
  - {{name: rover 2, kinematics: {{name: diff}}, state: [1, 6, -0.5], goal: [9, 6, 0], behavior: {{name: dash}},
      shape: {{name: circle, radius: 0.2}}, sensors: {SENSORS}}}
obstacle:
  - {{name: walker, kinematics: {{name: omni}}, state: [6, 6, 0], goal: [9, 2, 0], behavior: {{name: dash}},
      shape: {{name: circle, radius: 0.2}}}}
  - {{name: crate, shape: {{name: rectangle, length: 1, width: 2}}, state: [4, 4, 0.3]}}
  - {{name: hook, shape: {{name: polygon, vertices: [[0, 0], [2, 0], [2, 1], [1, 0.2], [0, 1]]}}, state: [8, 3, 0]}}
"""


@pytest.fixture
def hall() -> Run:
    """Two robots with two lidars each, a moving and two static obstacles; one robot arrives."""
    return recorded(HALL, 60, seed=3)
