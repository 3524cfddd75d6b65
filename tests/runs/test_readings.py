"""Records keep what odometry, localization, detectors and other sensors without beams reported."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app
from irsim.runs import RunError
from irsim.runs.inspection import inspect_run
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


def test_tables_have_numbers_of_sensors_by_name(workspace: Path) -> None:
    write(workspace)
    irsim.run("scene.yaml", seed=0, record="kept", steps=12)
    trace = open_run("kept").trace()
    table = inspect_run(
        "kept", fields=["x", "odometry_2.theta", "imu.yaw_rate", "detector.object"], every=1, limit=None
    )
    assert table.columns == ["step", "time", "robot", "x", "detector.object", "odometry_2.theta", "imu.yaw_rate"]
    tom, ann = table.rows[10:12]
    assert tom[:3] == [5, 0.5, "tom"]
    assert tom[4:] == ["1", pytest.approx(trace.readings["tom/odometry_2"]["theta"][5], abs=1e-4), None], "no imu"
    assert ann[4:6] == [None, None]
    assert ann[6] == pytest.approx(trace.readings["ann/imu"]["yaw_rate"][5], abs=1e-4)
    whole = inspect_run("kept", robot="ann", fields=["readings"])
    assert whole.columns[3:] == ["imu.yaw_rate", "imu.ax", "imu.ay"]
    with pytest.raises(RunError, match=r"'odometri\.x' is not a valid field.*odometry\.x"):
        inspect_run("kept", fields=["odometri.x"])


def test_the_command_prints_readings(workspace: Path) -> None:
    write(workspace)
    irsim.run("scene.yaml", seed=0, record="kept", steps=3)
    told = CliRunner().invoke(app, ["inspect", "kept", "--objects", "ann", "--fields", "readings", "--csv"])
    assert told.exit_code == 0
    assert told.stdout.splitlines()[0] == "step,time,robot,imu.yaw_rate,imu.ax,imu.ay"


def test_arrays_have_the_readings_with_their_units(workspace: Path) -> None:
    write(workspace)
    irsim.run("scene.yaml", seed=0, record="kept", steps=12)
    trace = open_run("kept").trace()
    irsim.export_run("kept", "kept.npz")
    with np.load("kept.npz") as arrays:
        for key, block in trace.readings.items():
            read = arrays[f"readings/{key}"]
            assert read.dtype.names == block.dtype.names
            assert read.tobytes() == block.tobytes(), key
        units = json.loads(str(arrays["about"]))["units"]
    assert units["readings/ann/imu"] == {"yaw_rate": "rad/s", "ax": "m/s^2", "ay": "m/s^2"}


@pytest.mark.parametrize("ranges", [False, True])
def test_tables_of_text_have_a_column_for_each_number(workspace: Path, ranges: bool) -> None:
    write(workspace)
    irsim.run("scene.yaml", seed=0, record="kept", steps=12)
    trace = open_run("kept").trace()
    irsim.export_run("kept", "kept.csv", ranges=ranges)
    with open("kept.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    tom, ann = ([row for row in rows if row["name"] == name] for name in ("tom", "ann"))
    assert [float(row["odometry.x"]) for row in tom] == trace.readings["tom/odometry"]["x"].tolist()
    assert [float(row["imu.ax"]) for row in ann] == trace.readings["ann/imu"]["ax"].tolist()
    assert {row["odometry.x"] for row in ann} == {""}
    assert ("detector.x" in rows[0]) is ranges
    if ranges:
        assert float(tom[4]["detector.x"]) == pytest.approx(trace.readings["tom/detector"]["x"][4, 0], abs=1e-5)


def write(workspace: Path) -> str:
    path = workspace / "scene.yaml"
    path.write_text(SCENE)
    return str(path)
