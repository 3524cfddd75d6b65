"""Reports of sensors without beams, in files that others read."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.runs import Run
from tests.bridges.export.test_mcap import Bag, decoded, yaw
from tests.bridges.scenes import recorded
from tests.bridges.sensing import SCENE

pytestmark = pytest.mark.records
ORIGIN = [48.1, 11.6, 520.0]


@pytest.fixture
def run(workspace: object) -> Run:
    return recorded(SCENE, 50, seed=2)


@pytest.fixture
def bag(run: Run) -> Bag:
    irsim.export_run(run, "run.mcap")
    return decoded("run.mcap")


def messages(bag: Bag, topic: str) -> list[Any]:
    assert len(bag[topic]) == 51
    return [message for _, message in bag[topic]]


def matrix(values: Any, size: int) -> np.ndarray:
    return np.array(values).reshape(size, size)


def test_inertial_units_report_rates_and_gravity_without_an_orientation(run: Run, bag: Bag) -> None:
    readings = run.trace().readings["rover/imu"]
    for imu, reading in zip(messages(bag, "/rover/imu"), readings, strict=True):
        assert imu.angular_velocity.z == reading["yaw_rate"]
        assert [imu.linear_acceleration.x, imu.linear_acceleration.y] == [reading["ax"], reading["ay"]]
    assert imu.linear_acceleration.z == pytest.approx(9.80665)
    assert imu.orientation_covariance[0] == -1
    assert matrix(imu.angular_velocity_covariance, 3)[2, 2] == pytest.approx(0.01**2 / 0.1 + 0.02**2)
    assert matrix(imu.linear_acceleration_covariance, 3)[0, 0] == pytest.approx(0.05**2 / 0.1)
    assert imu.header.frame_id == "rover/imu"
    mounts = {item.child_frame_id: item.transform for item in bag["/tf_static"][0][1].transforms}
    assert (mounts["rover/imu"].translation.x, yaw(mounts["rover/imu"].rotation)) == pytest.approx((0.1, 0.5))


def test_a_slow_sensor_has_a_message_for_each_measurement(run: Run, bag: Bag) -> None:
    readings = run.trace().readings["rover/imu_2"]
    for number, (time, imu) in enumerate(bag["/rover/imu_1"]):
        due = math.ceil(number / 4 / 0.1 - 1e-9) * 0.1
        assert imu.header.stamp.sec + imu.header.stamp.nanosec / 1e9 == pytest.approx(due)
        assert time == pytest.approx(due + 0.3), "when it arrives"
        assert imu.angular_velocity.z == readings["yaw_rate"][round(time / 0.1)]
    assert number == 18


def test_wheel_odometry_becomes_as_unsure_as_its_errors_are(run: Run, bag: Bag) -> None:
    readings = run.trace().readings["rover/odometry"]
    told = messages(bag, "/rover/wheel_odom")
    assert not any(told[0].pose.covariance)
    for odometry, reading in zip(told, readings, strict=True):
        place = odometry.pose.pose
        assert (place.position.x, place.position.y) == (reading["x"], reading["y"])
        assert yaw(place.orientation) == pytest.approx(math.remainder(reading["theta"], 2 * math.pi))
        assert odometry.twist.twist.linear.x == reading["vx"]
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("world", "rover/base_link")
    # Many paths with these errors, drawn with NumPy, around the one that was reported.
    steps = np.stack([readings["vx"], readings["yaw_rate"]], axis=1)[1:] * 0.1
    draw = np.random.default_rng(0).normal(size=(4000, len(steps), 2))
    way, turn = np.abs(steps[:, 0]), np.abs(steps[:, 1])
    ahead = steps[:, 0] + draw[:, :, 0] * 0.05 * np.sqrt(way)
    turned = steps[:, 1] + draw[:, :, 1] * np.sqrt(0.02**2 * way + 0.03**2 * turn)
    heading = 0.2 + np.cumsum(turned, axis=1)
    middle = heading - turned / 2
    ends = np.stack([(ahead * np.cos(middle)).sum(1), (ahead * np.sin(middle)).sum(1), heading[:, -1]])
    expected, measured = np.cov(ends), matrix(odometry.pose.covariance, 6)[np.ix_([0, 1, 5], [0, 1, 5])]
    np.testing.assert_allclose(np.diag(measured), np.diag(expected), rtol=0.12)
    assert np.corrcoef(ends)[1, 2] == pytest.approx(
        measured[1, 2] / math.sqrt(measured[1, 1] * measured[2, 2]), abs=0.06
    )


def test_satellite_navigation_gives_places_on_the_earth_and_none_in_a_tunnel(run: Run, bag: Bag) -> None:
    readings = run.trace().readings["rover/gnss"]
    statuses = set()
    for fix, reading in zip(messages(bag, "/rover/gnss"), readings, strict=True):
        statuses.add(fix.status.status)
        assert fix.status.status == (0 if reading["quality"] else -1)
        if not reading["quality"]:
            assert math.isnan(fix.latitude)
            assert fix.position_covariance_type == 0
            continue
        north = (fix.latitude - ORIGIN[0]) * 111_199.6  # a degree of the meridian at this latitude [m]
        east = (fix.longitude - ORIGIN[1]) * 74_487.0  # and of the parallel
        assert [east, north] == pytest.approx([reading["x"], reading["y"]], rel=2e-3, abs=0.01)
        assert fix.altitude == pytest.approx(520, abs=1e-3)
        assert matrix(fix.position_covariance, 3)[0, 0] == pytest.approx(reading["std"] ** 2)
    assert statuses == {0, -1}


def test_rangers_report_their_cone_and_nothing_where_nothing_is(run: Run, bag: Bag) -> None:
    trace, missed = run.trace(), set()
    for topic, key, kind, reach in (
        ("/rover/sonar", "rover/sonar", 0, 3),
        ("/rover/sonar_1", "rover/sonar_2", 0, 9),
        ("/rover/ir_range", "rover/ir_range", 1, 1.5),
    ):
        for ranger, reading in zip(messages(bag, topic), trace.readings[key], strict=True):
            assert (ranger.radiation_type, ranger.max_range) == (kind, reach)
            assert ranger.field_of_view == pytest.approx(reading["field_of_view"])
            missed.add((topic, math.isinf(ranger.range)))
            if reading["valid"]:
                assert ranger.range == pytest.approx(reading["range"])
            else:
                assert ranger.range == math.inf
    assert missed >= {("/rover/sonar", True), ("/rover/sonar_1", False), ("/rover/ir_range", True)}


def test_localization_is_a_pose_with_its_errors(run: Run, bag: Bag) -> None:
    readings = run.trace().readings["rover/localization"]
    for pose, reading in zip(messages(bag, "/rover/localization"), readings, strict=True):
        assert (pose.pose.pose.position.x, pose.pose.pose.position.y) == (reading["x"], reading["y"])
    assert np.diag(matrix(pose.pose.covariance, 6)) == pytest.approx([0.01, 0.01, 0, 0, 0, 0.0009])
    assert pose.header.frame_id == "world"


def test_a_scan_that_takes_time_has_the_stamp_of_its_first_beam(bag: Bag) -> None:
    between = 0.2 * (2 / 4) / (2 * math.pi)
    for time, scan in bag["/rover/scan"]:
        stamp = scan.header.stamp.sec + scan.header.stamp.nanosec / 1e9
        assert stamp == pytest.approx(max(0, time - 4 * between), abs=1e-8)
        assert (scan.time_increment, scan.scan_time) == pytest.approx((between, 0.2))


def test_a_bag_of_a_bridge_has_the_same_messages(workspace: object) -> None:
    irsim.run(text=SCENE, seed=2, steps=20, record="kept", bridges=[
        {"name": "rosbag", "folder": "live", "storage": "mcap"}])  # fmt: skip
    irsim.export_run("kept", "kept.mcap")
    [file] = Path("live").glob("*.mcap")
    live, kept = decoded(str(file)), decoded("kept.mcap")
    for topic in ("imu", "imu_1", "wheel_odom", "gnss", "sonar_1", "localization"):
        assert len(live[f"/rover/{topic}"]) == len(kept[f"/rover/{topic}"]) == (7 if topic == "imu_1" else 21)
        for (_, one), (_, other) in zip(live[f"/rover/{topic}"], kept[f"/rover/{topic}"], strict=True):
            assert fields_of(one) == fields_of(other)


def fields_of(message: Any) -> Any:
    """The numbers of a message as text, without names of frames."""
    if isinstance(message, (float, int)):
        return repr(message)
    if isinstance(message, str):
        return None
    if isinstance(message, (list, tuple, np.ndarray)):
        return [fields_of(one) for one in message]
    return [fields_of(getattr(message, name)) for name in message.__slots__]


def test_parquet_has_the_numbers_with_units_and_lists_of_tracks(run: Run) -> None:
    import pyarrow.parquet as pq

    irsim.export_run(run, "run.parquet", objects="robots")
    table, trace = pq.read_table("run.parquet"), run.trace()
    field = table.schema.field("odometry.yaw_rate")
    assert field.metadata[b"unit"] == b"rad/s"
    assert table["gnss.x"].to_pylist()[:3] == trace.readings["rover/gnss"]["x"][:3].tolist()
    assert None in table["gnss.x"].to_pylist(), "in the tunnel"
    tracks = table["detector.x"].to_pylist()
    assert tracks[10] == pytest.approx(trace.readings["rover/detector"]["x"][10, :1])
    assert all(len(some) == 1 for some in tracks)
