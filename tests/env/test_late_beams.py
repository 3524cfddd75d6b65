"""Pictures and replay pages draw scans that are old from where their lidar was when it measured."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from irsim.objects.sensors.drawing import draw_scan
from irsim.runs.replay.data import pack_run
from tests.runs.replay.conftest import recorded
from tests.runs.replay.reading import unpacked

SCENE = """\
world: {width: 12, height: 10, step_time: 0.1}
robot:
  name: late
  kinematics: {name: diff}
  state: [1, 5, 0]
  goal: [11, 5]
  vel_max: [2, 1]
  behavior: {name: dash}
  sensors: [{name: lidar2d, number: 9, angle_range: 0.4, range_max: 20, TIMES}]
obstacle: {shape: {name: rectangle, length: 0.2, width: 10}, state: [11.6, 5]}
"""
WALL_M = 11.5


@pytest.mark.parametrize("times", ["latency: 0.5", "rate: 3", "rate: 4, latency: 0.3", "range_min: 0"])
def test_beams_end_at_the_wall_that_they_measured(make: Callable[..., Any], times: str) -> None:
    env = make(SCENE.replace("TIMES", times))
    lidar = env.robot.sensors[0]
    seen = []
    for _ in range(24):
        env.step()
        beams = draw_scan(lidar)
        if np.isfinite(lidar.stamp):
            assert beams.ends[:, 0] == pytest.approx(WALL_M)
            assert beams.origin[0] == pytest.approx(1 + 2 * lidar.stamp)
        seen.append(float(env.robot.state[0, 0]) - beams.origin[0])
    env.end(0)
    assert (max(seen) > 0.3) == (times != "range_min: 0")


def test_a_lidar_without_data_yet_is_drawn_where_it_is(make: Callable[..., Any]) -> None:
    env = make(SCENE.replace("TIMES", "latency: 1"))
    for _ in range(3):
        env.step()
    assert draw_scan(env.robot.sensors[0]).origin[0] == pytest.approx(float(env.robot.state[0, 0]))
    env.end(0)


@pytest.mark.parametrize("times", ["latency: 0.5", "rate: 4, latency: 0.3"])
def test_a_replay_knows_from_where_each_scan_was_measured(workspace: Path, times: str) -> None:
    run = recorded(SCENE.replace("TIMES", times), steps=30)
    head, columns = unpacked(pack_run(run).data)
    [lidar] = head["lidars"]
    places, ranges = columns[lidar["from"]] / 1000, columns[lidar["scan"]] * lidar["quantum"]
    x = columns["x"][head["objects"][0]["track"]] * head["quanta"][0]
    told = places >= 0
    assert told.sum() > 20
    assert not told[:3].any()
    middle = np.interp(places[told], np.arange(len(x)), x) + ranges[4, told]
    assert middle == pytest.approx(np.full(told.sum(), WALL_M), abs=0.01)
    assert (x[told] + ranges[4, told]).max() > WALL_M + 0.5, "from the present pose beams would end behind the wall"


def test_a_replay_of_a_lidar_that_is_never_late_has_no_such_places(workspace: Path) -> None:
    head, columns = unpacked(pack_run(recorded(SCENE.replace("TIMES", "range_min: 0"), steps=5)).data)
    assert "from" not in head["lidars"][0]
    assert "from0" not in columns
