"""Scenarios to record, and a place to record them in."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import irsim
from irsim.runs import Run, open_run
from irsim.runs.inspection import inspect_run

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


def recorded(scenario: Path | None = None, seed: int = 0, **options: Any) -> Run:
    """The record of a new run."""
    return open_run(str(irsim.run(scenario, seed=seed, record=True, **options).run_id))


def first_row(run: Run | Path, **asked: Any) -> dict[str, Any]:
    """The first row of a table of a run, by the names of its columns."""
    table = inspect_run(run, **asked)
    return dict(zip(table.columns, table.rows[0], strict=True))
