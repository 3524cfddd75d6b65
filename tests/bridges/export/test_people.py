"""``isaac_people``: commands that lead characters along the recorded ways, and let them stand where they stood."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import shapely

from irsim.bridges.export.export import export_run
from irsim.diagnostics.errors import ArgumentError
from irsim.runs import Run
from tests.bridges.scenes import recorded

SCENE = """
world: {width: 20, height: 20, step_time: 0.1}
robot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [18, 1]}
obstacle:
  - {name: walker, kinematics: {name: omni_angular}, behavior: {name: replay, vanish: false, times: [0, 2, 4, 7, 9],
     poses: [[2, 3], [4, 3], [4, 5], [4, 5], [6, 6]]}}
  - {name: late one, kinematics: {name: omni_angular},
     behavior: {name: replay, times: [1.5, 9], poses: [[9, 9], [9, 2]]}}
  - {name: stands, kinematics: {name: omni_angular},
     behavior: {name: replay, times: [0, 10], poses: [[12, 5], [12, 5]]}}
  - {name: crate, state: [15, 15, 0]}
"""


@pytest.fixture
def run() -> Run:
    return recorded(SCENE, 90)


def lines_of(run: Run, **options) -> list[str]:
    result = export_run(run, Path("people.txt"), to="isaac_people", overwrite=True, **options)
    assert result.format == "isaac_people"
    return Path("people.txt").read_text().splitlines()


def test_commands(run: Run) -> None:
    assert lines_of(run) == [
        "Spawn walker 2 3 0 0",
        "Spawn late_one 9 9 0 -90",
        "Spawn stands 12 5 0 0",
        "walker GoTo 4 3 0 4 5 0 _",
        "walker Idle 3.1",
        "walker GoTo 6 6 0 _",
        "late_one Idle 1.5",
        "late_one GoTo 9 2 0 _",
        "stands Idle 9",
    ]


def test_notes_and_options(run: Run) -> None:
    result = export_run(run, Path("some.txt"), to="isaac_people")
    assert result.objects == ["walker", "late one", "stands"]
    assert [note.split(":")[0] for note in result.notes[-2:]] == [
        "not in the world at the start, so standing where they appear before",
        "named with letters, digits and underscores only",
    ]
    lines = lines_of(run, objects=["walker"], options={"z": 1.25, "pause": 5})
    assert lines == ["Spawn walker 2 3 1.25 0", "walker GoTo 4 3 1.25 4 5 1.25 6 6 1.25 _"]
    assert lines_of(run, objects="robots")[0].startswith("Spawn robot_0 1 1 0 ")
    with pytest.raises(ArgumentError, match=r"isaac_people: 'pause' must be > 0 \[s\], got 0"):
        lines_of(run, options={"pause": 0})


@pytest.mark.parametrize("tolerance", [0.02, 0.3])
def test_the_ways_are_those_of_the_run(tolerance: float) -> None:
    scene = """
    world: {width: 20, height: 20}
    robot: {kinematics: {name: omni}, state: [3, 10, 0], goal: [17, 10.5], behavior: {name: dash}}
    obstacle:
      - {number: 4, kinematics: {name: omni}, distribution: {name: circle_crossing, radius: 6}, behavior: {name: rvo}}
    """
    run = recorded(scene, 150, seed=3)
    lines = lines_of(run, options={"tolerance": tolerance})
    trace = run.trace()
    for name in ("obstacle_1", "obstacle_2", "obstacle_3", "obstacle_4"):
        start = next(line.split()[2:4] for line in lines if line.startswith(f"Spawn {name} "))
        ways = [line.split()[2:-1] for line in lines if line.startswith(f"{name} GoTo")]
        points = np.array([[float(value) for value in start]])
        for way in ways:
            points = np.concatenate([points, np.array(way, float).reshape(-1, 3)[:, :2]])
        driven = trace.pose[:, run.names.index(name), :2]
        path = shapely.LineString(points)
        assert max(path.distance(shapely.Point(place)) for place in driven) <= 2 * tolerance + 1e-3
        assert math.dist(points[-1], driven[-1]) <= tolerance + 1e-3
        assert len(points) < len(driven) / 3
