"""Pages of runs in headless Chromium."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import irsim
from irsim.runs import Run
from tests.browser import Watched

CROWD = """\
world: {width: 40, height: 40, time_limit: 100, step_time: 0.1, collision_mode: unobstructed}
robot:
  - number: 100
    kinematics: {name: diff}
    behavior: {name: dash, wander: true, range_low: [1, 1, -3.14], range_high: [39, 39, 3.14]}
    distribution: {name: random, range_low: [1, 1, -3], range_high: [39, 39, 3]}
    shape: {name: circle, radius: 0.2}
    sensors: [{name: lidar2d, number: 180, range_max: 8}]
obstacle:
  - number: 20
    distribution: {name: random, range_low: [2, 2, 0], range_high: [38, 38, 0]}
    shape: {name: circle, radius: 0.6}
"""


@pytest.fixture
def shown(run: Run, watched: Watched) -> Any:
    """The page of a run with three robots."""
    return watched.open(Path(irsim.replay(run).file))


@pytest.fixture(scope="session")
def crowd(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Page of a hundred robots over a thousand steps."""
    folder = tmp_path_factory.mktemp("crowd")
    irsim.run(text=CROWD, seed=1, steps=1000, record=folder / "run")
    target = folder / "crowd.html"
    result = irsim.replay(folder / "run", target)
    assert (result.last_step, result.every) == (1000, 1)
    return target
