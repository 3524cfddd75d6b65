"""MCAP files as mcap-ros2-support decodes them, which is an implementation of CDR of its own."""

from __future__ import annotations

import json
import math
from collections import defaultdict
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.objects.describe import describe_scene
from irsim.runs import Run, open_run
from tests.bridges.export.conftest import HALL
from tests.bridges.scenes import recorded
from tests.components.test_unknown_cells import robot, write_map

pytestmark = pytest.mark.records
Bag = dict[str, list[tuple[float, Any]]]
"""Time [s] and message of each topic."""


def decoded(file: str) -> Bag:
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    by_topic = defaultdict(list)
    with open(file, "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, channel, message, content in reader.iter_decoded_messages():
            by_topic[channel.topic].append((message.log_time / 1e9, content))
    return dict(by_topic)


def yaw(quaternion: Any) -> float:
    return 2 * math.atan2(quaternion.z, quaternion.w)


@pytest.fixture
def bag(hall: Run) -> Bag:
    irsim.export_run(hall, "run.mcap")
    return decoded("run.mcap")


def test_topics_are_those_of_a_robot(hall: Run, bag: Bag) -> None:
    robots = {f"/rover_{n}/{topic}" for n in (1, 2) for topic in ("odom", "scan", "scan_1", "goal")}
    assert set(bag) == robots | {"/clock", "/tf", "/tf_static", "/obstacles", "/obstacles/ids", "/rosout", "/markers"}
    for topic in ("/clock", "/tf", "/obstacles", "/rover_1/odom", "/rover_2/scan_1"):
        assert [time for time, _ in bag[topic]] == pytest.approx(hall.trace().time.tolist())
    assert all(len(bag[topic]) == 1 for topic in ("/tf_static", "/markers", "/obstacles/ids", "/rover_1/goal"))


def test_poses_are_those_of_the_record_everywhere(hall: Run, bag: Bag) -> None:
    trace = hall.trace()
    for row in (0, 1, 30, 60):
        x, y, theta = trace.pose[row, 0].tolist()
        time, odometry = bag["/rover_1/odom"][row]
        assert time == pytest.approx(trace.time[row])
        assert (odometry.header.frame_id, odometry.child_frame_id) == ("world", "rover_1/base_link")
        stamp = odometry.header.stamp
        assert stamp.sec + stamp.nanosec / 1e9 == pytest.approx(trace.time[row])
        clock = bag["/clock"][row][1].clock
        assert (clock.sec, clock.nanosec) == (stamp.sec, stamp.nanosec)
        place = odometry.pose.pose
        assert (place.position.x, place.position.y) == (x, y)
        assert yaw(place.orientation) == pytest.approx(theta)
        moved = {item.child_frame_id: item for item in bag["/tf"][row][1].transforms}
        assert set(moved) == {"rover_1/base_link", "rover_2/base_link", "walker/base_link"}
        assert moved["rover_1/base_link"].transform.translation.x == x
        [walker] = bag["/obstacles"][row][1].poses
        assert [walker.position.x, walker.position.y] == trace.pose[row, 2, :2].tolist()


def test_twists_are_in_the_frame_of_the_body(hall: Run, bag: Bag) -> None:
    control = hall.trace().control[:, 0]
    for row in (1, 10, 40):
        twist = bag["/rover_1/odom"][row][1].twist.twist
        assert twist.linear.x == pytest.approx(control[row, 0], abs=1e-6)
        assert twist.linear.y == pytest.approx(0, abs=1e-9)  # a differential drive does not slip
        assert twist.angular.z == pytest.approx(control[row, 1], abs=1e-6)


def test_scans_have_their_angles_and_infinite_misses(hall: Run, bag: Bag) -> None:
    kept = hall.trace().ranges["rover 1/0"]
    assert np.isinf(kept).any()
    assert np.isfinite(kept).any()
    for row, (_, scan) in enumerate(bag["/rover_1/scan"]):
        np.testing.assert_array_equal(np.float32(scan.ranges), kept[row])
    assert (scan.angle_min, scan.angle_max, scan.angle_increment) == pytest.approx((-1, 1, 0.5))
    assert (scan.range_min, scan.range_max, scan.scan_time) == pytest.approx((0.1, 3, 0.1))
    assert scan.header.frame_id == "rover_1/laser"
    mounts = {item.child_frame_id: item for item in bag["/tf_static"][0][1].transforms}
    assert set(mounts) == {f"rover_{n}/laser{end}" for n in (1, 2) for end in ("", "_1")}
    mount = mounts["rover_1/laser"]
    assert mount.header.frame_id == "rover_1/base_link"
    assert (mount.transform.translation.x, yaw(mount.transform.rotation)) == pytest.approx((0.2, 0.1))


def test_goals_and_events_come_when_they_change(hall: Run, bag: Bag) -> None:
    [(_, goal)] = bag["/rover_1/goal"]
    assert (goal.pose.position.x, goal.pose.position.y, goal.header.frame_id) == (5, 1, "world")
    logged = [(round(time, 6), log.name, log.msg.split()[0], log.level) for time, log in bag["/rosout"]]
    levels = {"arrival": 20, "waypoint": 20, "collision": 30, "no_path": 30}
    assert logged == [(round(e.time, 6), e.object, e.kind, levels[e.kind]) for e in hall.events]
    assert any(kind == "arrival" for _, _, kind, _ in logged)


def test_markers_have_the_shapes(bag: Bag) -> None:
    [(_, array)] = bag["/markers"]
    bodies = {marker.id: marker for marker in array.markers if marker.ns == "bodies"}
    names = [marker.text for marker in array.markers if marker.ns == "names"]
    assert names == ["rover 1", "rover 2"]
    assert (bodies[0].type, bodies[0].header.frame_id, bodies[0].frame_locked) == (3, "rover_1/base_link", True)
    assert bodies[0].scale.x == bodies[0].scale.y == pytest.approx(0.4)
    crate, hook = bodies[3], bodies[4]
    assert (crate.header.frame_id, crate.pose.position.x, crate.pose.position.y) == ("world", 4, 4)
    assert yaw(crate.pose.orientation) == pytest.approx(0.3)
    assert area(crate.points) == pytest.approx(2)
    assert area(hook.points) == pytest.approx(1.2)  # concave: its hull would have 2
    assert array.markers[0].action == 3  # of a scene before nothing is left
    assert all(0 < marker.color.a <= 1 for marker in array.markers[1:])


COMERS = """\
world: {width: 12, height: 8, step_time: 0.1}
robot:
  - {name: late, kinematics: {name: diff}, state: [1, 1, 0], goal: [5, 1, 0], behavior: {name: dash}, appear_time: 1,
     sensors: [{name: lidar2d, number: 5}]}
  - {name: early, kinematics: {name: diff}, state: [1, 6, 0], goal: [9, 6, 0], behavior: {name: dash}}
obstacle:
  - {name: guest, kinematics: {name: omni}, state: [6, 3, 0],
     behavior: {name: replay, times: [0.5, 1.5], poses: [[6, 3, 0], [7, 3, 0]]}}
  - {name: never, kinematics: {name: omni}, state: [8, 3, 0], goal: [8, 1, 0], behavior: {name: dash}, appear_time: 50}
"""


def test_who_is_not_there_is_in_no_message() -> None:
    run = recorded(COMERS, 25, seed=1)
    assert np.isnan(run.trace().pose).any()
    irsim.export_run(run, "run.mcap")
    bag = decoded("run.mcap")
    for _, message in bag["/tf"]:
        for moved in message.transforms:
            assert math.isfinite(moved.transform.translation.x)
    assert all(math.isfinite(pose.position.x) for _, array in bag["/obstacles"] for pose in array.poses)
    assert min(time for time, _ in bag["/late/odom"]) == pytest.approx(1.0)
    assert min(time for time, _ in bag["/late/scan"]) == pytest.approx(1.0)
    names = [json.loads(message.data) for _, message in bag["/obstacles/ids"]]
    assert "never" not in [name for known in names for name in known]
    assert ["guest"] in names
    assert names[-1] == []  # it left
    counts = {time: len(array.poses) for time, array in bag["/obstacles"]}
    for time, message in bag["/obstacles/ids"]:
        assert counts[time] == len(json.loads(message.data))
    shown = [{marker.header.frame_id for marker in array.markers[1:]} for _, array in bag["/markers"]]
    assert "guest/base_link" not in shown[-1]
    assert "late/base_link" in shown[-1]
    assert all("never/base_link" not in frames for frames in shown)


def area(points: list[Any]) -> float:
    """Total area of triangles [m2]."""
    corners = np.array([(point.x, point.y) for point in points]).reshape(-1, 3, 2)
    one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return float(np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]).sum() / 2)


def test_the_file_tells_what_it_shows(hall: Run) -> None:
    from mcap.reader import make_reader

    irsim.export_run(hall, "run.mcap")
    with open("run.mcap", "rb") as file:
        bag = make_reader(file)
        header, summary = bag.get_header(), bag.get_summary()
        [attachment] = bag.iter_attachments()
        [metadata] = bag.iter_metadata()
    assert header.profile == "ros2"
    assert summary.statistics.message_count > 500
    assert {schema.encoding for schema in summary.schemas.values()} == {"ros2msg"}
    assert (attachment.name, attachment.data.decode()) == ("scenario.yaml", HALL)
    assert (metadata.metadata["id"], metadata.metadata["seed"]) == (hall.id, "3")
    latched = {
        c.topic for c in summary.channels.values() if "durability: 1" in c.metadata.get("offered_qos_profiles", "")
    }
    assert latched == {"/tf_static", "/markers", "/obstacles/ids"}
    obstacles = next(c for c in summary.channels.values() if c.topic == "/obstacles")
    assert json.loads(obstacles.metadata["names"]) == ["walker"]


def test_messages_are_in_the_order_of_time(hall: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    from mcap.records import Message
    from mcap.stream_reader import StreamReader

    monkeypatch.setattr("irsim.bridges.export.episode._BLOCK_NUMBERS", 700)
    irsim.export_run(hall, "run.mcap")
    with open("run.mcap", "rb") as file:
        messages = [record for record in StreamReader(file).records if isinstance(record, Message)]
    times = [message.log_time for message in messages]
    assert len(times) > 500
    assert times == sorted(times)
    assert len(decoded("run.mcap")["/rover_1/goal"]) == 1  # not again in each block


def test_maps_are_occupancy_grids() -> None:
    text = "world: {width: 20, height: 10, offset: [-3, 2], obstacle_map: {name: perlin, resolution: 0.5, seed: 3}}\n"
    text += "robot: {kinematics: {name: diff}, state: [2, 4, 0], goal: [3, 4, 0], behavior: {name: dash}}\n"
    assert irsim.export_run(recorded(text, 3), "run.mcap").notes == []
    [(_, grid)] = decoded("run.mcap")["/map"]
    assert (grid.info.width, grid.info.height) == (40, 20)
    assert grid.info.resolution == pytest.approx(0.5)
    assert (grid.info.origin.position.x, grid.info.origin.position.y) == (-3, 2)
    assert set(grid.data) <= set(range(101))
    assert len(grid.data) == 800
    assert max(grid.data) > 50


def test_maps_say_what_is_unknown(tmp_path) -> None:
    file = write_map(tmp_path, robot())
    irsim.run(file, steps=2, record=tmp_path / "run")
    irsim.export_run(open_run(tmp_path / "run"), "run.mcap")
    [(_, grid)] = decoded("run.mcap")["/map"]
    cells = np.reshape(grid.data, (100, 100)).T
    assert ((cells == -1) == (describe_scene(irsim.make(file, display=False).simulation).grid.unknown)).all()
    assert (cells > 50).sum() == 1000
