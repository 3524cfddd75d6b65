"""Scenarios to record, and a place to record them in."""

from __future__ import annotations

from pathlib import Path

import pytest

ROOM = """\
world: {width: 8, height: 6, time_limit: 20}
robot:
  - name: rover
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.3}
    state: [1, 1, 0]
    goal: [4, 3, 0]
    behavior: {name: dash}
    sensors: [{name: lidar2d, number: 7, range_max: 3}]
obstacle:
  - {name: crate, shape: {name: circle, radius: 0.5}, state: [4, 5, 0]}
"""

CRASH = ROOM.replace("goal: [4, 3, 0]", "goal: [7, 1, 0]").replace("state: [4, 5, 0]", "state: [4, 1, 0]")


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current directory."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def room(workspace: Path) -> Path:
    """A robot with a lidar that arrives."""
    path = workspace / "room.yaml"
    path.write_text(ROOM, encoding="utf-8")
    return path


@pytest.fixture
def crash(workspace: Path) -> Path:
    """A robot that collides."""
    path = workspace / "crash.yaml"
    path.write_text(CRASH, encoding="utf-8")
    return path
