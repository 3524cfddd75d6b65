"""Runs to export, and where they are recorded."""

from __future__ import annotations

from pathlib import Path

import pytest

import irsim
from irsim.runs import Run, open_run

HALL = """\
world: {width: 12, height: 8, collision_mode: unobstructed}
robot:
  - name: rover 1
    kinematics: {name: diff}
    state: [1, 1, 0.5]
    goal: [5, 1, 0]
    behavior: {name: dash}
    shape: {name: circle, radius: 0.2}
    sensors:
      - {name: lidar2d, number: 5, range_max: 3, range_min: 0.1, angle_range: 2, offset: [0.2, 0, 0.1]}
      - {name: lidar2d, number: 3, range_max: 9}
  - name: rover 2
    kinematics: {name: diff}
    state: [1, 6, -0.5]
    goal: [9, 6, 0]
    behavior: {name: dash}
    shape: {name: circle, radius: 0.2}
    sensors:
      - {name: lidar2d, number: 5, range_max: 3, range_min: 0.1, angle_range: 2, offset: [0.2, 0, 0.1]}
      - {name: lidar2d, number: 3, range_max: 9}
obstacle:
  - name: walker
    kinematics: {name: omni}
    shape: {name: circle, radius: 0.2}
    state: [6, 6, 0]
    goal: [9, 2, 0]
    behavior: {name: dash}
  - {name: crate, shape: {name: rectangle, length: 1, width: 2}, state: [4, 4, 0.3]}
  - {name: hook, shape: {name: polygon, vertices: [[0, 0], [2, 0], [2, 1], [1, 0.2], [0, 1]]}, state: [8, 3, 0]}
"""


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current directory."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def hall(workspace: Path) -> Run:
    """Two robots with two lidars each, a moving and two static obstacles; one robot arrives."""
    return open_run(str(irsim.run(text=HALL, seed=3, steps=60, record=True).run_id))
