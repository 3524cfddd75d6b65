"""Records keep what odometry, localization, detectors and other sensors without beams reported."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import irsim
from irsim.runs.reading import open_run

SCENE = """
world: {width: 12, height: 12}
robot:
  - name: tom
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.2}
    state: [2, 6, 0]
    goal: [9, 6]
    behavior: {name: dash}
    sensors:
      [{name: lidar2d, number: 5}, {name: odometry}, {name: detector, max_tracks: 3}, {name: odometry, track: 0.5}]
  - {name: ann, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [2, 2, 0], goal: [9, 2],
     behavior: {name: dash}, sensors: [{name: imu, gyro_noise: 0.01}]}
"""


def test_a_record_has_the_numbers_of_every_step_by_name(workspace: Path) -> None:
    read = []
    env = irsim.make(write(workspace), display=False)
    for _ in range(12):
        env.step()
        read.append([env.robot_list[0].sensors[1].read(), env.robot_list[1].sensors[0].read()])
    env.end(0)
    irsim.run("scene.yaml", seed=0, record="kept", steps=12)
    trace = open_run("kept").trace()
    assert list(trace.readings) == ["tom/odometry", "tom/detector", "tom/odometry_2", "ann/imu"]
    assert all(len(block) == 13 for block in trace.readings.values())
    for step, (odometry, _) in enumerate(read, 1):
        for name, value in odometry.items():
            assert trace.readings["tom/odometry"][name][step] == pytest.approx(value), name
    tracks = trace.readings["tom/detector"]
    assert tracks.shape == (13, 3)
    assert tracks["object"][5].tolist()[:1] == [1.0]
    assert np.isnan(tracks["x"][5, 1:]).all()
    assert np.ptp(trace.readings["ann/imu"]["yaw_rate"]) > 0
    [alone] = open_run("kept").blocks(100, [1])
    assert list(alone.readings) == ["ann/imu"]


def test_a_record_that_is_full_has_the_numbers_of_its_first_steps(
    workspace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    irsim.run(write(workspace), seed=0, record="whole", steps=60)
    monkeypatch.setattr("irsim.runs.recorder._MAX_SCANS_BYTES", 10_000)
    run_id = irsim.run("scene.yaml", seed=0, record=True, steps=60).run_id
    whole, full = open_run("whole").trace(), open_run(str(run_id)).trace()
    assert (len(whole), len(full)) == (61, 61)
    kept = len(full.readings["ann/imu"])
    assert 0 < kept < 61
    for key, block in full.readings.items():
        assert block.tobytes() == whole.readings[key][:kept].tobytes(), key


def test_runs_part_where_a_reading_does(workspace: Path) -> None:
    write(workspace)
    irsim.run("scene.yaml", seed=0, record="one", steps=10)
    irsim.run("scene.yaml", seed=1, record="two", steps=10)
    apart = irsim.diff_runs("one", "two")
    assert not apart.same
    assert {parting.quantity for parting in apart.parted} <= {"imu.yaw_rate", "imu.ax", "imu.ay"}


def write(workspace: Path) -> str:
    path = workspace / "scene.yaml"
    path.write_text(SCENE)
    return str(path)
