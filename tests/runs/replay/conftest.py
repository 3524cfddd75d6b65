"""Runs to show, and a browser."""

from __future__ import annotations

import pytest

import irsim
from irsim.runs import Run, open_run

HOSTILE = "</script><script>window.hacked=1</script><img src=x onerror=window.hacked=1>"
SCENE = """\
world: {width: 12, height: 8, time_limit: 8}
robot:
  - name: rover
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.3}
    state: [1, 1, 0]
    goal: [5, 4, 0]
    behavior: {name: dash}
    sensors: [{name: lidar2d, number: 45, range_max: 4}]
  - name: NAME
    kinematics: {name: acker}
    shape: {name: rectangle, length: 1.2, width: 0.6, wheelbase: 0.8}
    state: [1, 6, 0]
    goal: [11, 6, 0]
    behavior: {name: dash}
  - name: slider
    kinematics: {name: omni}
    shape: {name: compound, parts: [{name: circle, radius: 0.2}, {name: rectangle, length: 0.8, width: 0.2}]}
    state: [11, 1, 1]
    goal: [11, 4, 1]
    behavior: {name: dash}
obstacle:
  - {name: crate, shape: {name: circle, radius: 0.5}, state: [6, 6, 0]}
  - {name: wall, shape: {name: linestring, vertices: [[3, 7], [5, 7.5], [8, 7]]}, state: [0, 0, 0], unobstructed: true}
  - {name: block, shape: {name: polygon, vertices: [[7, 2], [8, 2], [7.5, 3]]}, state: [0, 0, 0]}
"""


def recorded(text: str, seed: int = 1, **options: int) -> Run:
    """A run of a scenario, below the current directory."""
    result = irsim.run(text=text, seed=seed, record=True, **options)
    assert result.run_id is not None
    return open_run(result.run_id)


def scene(name: str = "lorry") -> str:
    """A scenario with robots of several shapes, one of which meets a crate."""
    return SCENE.replace("NAME", f'"{name}"')


@pytest.fixture
def run(workspace: object) -> Run:
    """Three robots: one arrives, one hits a crate, one slides."""
    return recorded(scene())
