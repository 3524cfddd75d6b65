"""Bags that we write, read by rosbags and mcap-ros2-support, and types for Cyclone DDS, which have their very bytes."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.bridges.ros.messages import Messages
from irsim.bridges.ros.outgoing import Outgoing
from irsim.bridges.ros.topics import TABLE, scene_topics
from irsim.bridges.state import world_state
from irsim.objects.describe import agent_rows, describe_scene
from tests.bridges.scenes import recorded
from tests.interop.ros.conftest import SCENE, MakeEnv

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("ros_others")]


SENSING = SCENE.replace(
    "sensors: [",
    "sensors: [{name: imu}, {name: odometry}, {name: gnss}, {name: sonar}, {name: ir_range}, {name: localization}, ",
)
"""The scene with a sensor of every kind that has a message."""


def by_rosbags(folder: Path) -> dict[str, list[Any]]:
    from rosbags.highlevel import AnyReader

    by_topic = defaultdict(list)
    with AnyReader([folder]) as reader:
        for connection, _, raw in reader.messages():
            by_topic[connection.topic].append(reader.deserialize(raw, connection.msgtype))
    return dict(by_topic)


def by_mcap(folder: Path) -> dict[str, list[Any]]:
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    by_topic = defaultdict(list)
    [file] = folder.glob("*.mcap")
    with file.open("rb") as stream:
        for _, channel, _, message in make_reader(stream, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
            by_topic[channel.topic].append(message)
    return dict(by_topic)


@pytest.mark.parametrize("storage", ["sqlite3", "mcap"])
def test_a_recorded_run_as_a_bag(storage: str) -> None:
    run, folder = recorded(SCENE, 30, seed=3), Path("bag-rosbag2")
    irsim.export_run(run, "bag-rosbag2", to="rosbag2", options={"storage": storage})
    ending = "db3" if storage == "sqlite3" else "mcap"
    assert sorted(path.name for path in folder.iterdir()) == [f"bag-rosbag2.{ending}", "metadata.yaml"]
    trace = run.trace()
    by_topic = by_rosbags(folder)
    for number, message in enumerate(by_topic["/robot_0/odom"]):
        assert message.pose.pose.position.x == trace.pose[number, 0, 0]
    np.testing.assert_array_equal(by_topic["/robot_0/scan"][7].ranges, trace.ranges["robot_0/0"][7])
    assert "robot_0" in (folder / "metadata.yaml").read_text()  # the scenario
    if storage == "mcap":
        again = by_mcap(folder)
        counts = [{topic: len(heard) for topic, heard in read.items()} for read in (again, by_topic)]
        assert counts[0] == counts[1]
        assert again["/robot_0/odom"][5].pose.pose.position.x == trace.pose[5, 0, 0]


def test_a_bag_that_is_recorded_while_running(make_env: MakeEnv) -> None:
    env = make_env(f"{SCENE}bridges: [{{name: rosbag, folder: lab}}]\n")
    xs = []
    with irsim.connect(env):
        for _ in range(20):
            env.step()
            xs.append(float(env.robot.state[0, 0]))
        assert not Path("lab").exists()  # only a complete bag has its name
    for by_topic in (by_rosbags(Path("lab")), by_mcap(Path("lab"))):
        assert [one.pose.position.x for one in by_topic["/robot_0/pose"][1:]] == xs
        assert len(by_topic["/clock"]) == 21
        assert len(by_topic["/map"]) == 1
    assert [path.name for path in Path("lab").iterdir() if path.name.startswith(".")] == []


def test_a_run_that_does_not_begin_leaves_no_bag(make_env: MakeEnv) -> None:
    env = make_env(f"{SCENE}bridges: [{{name: rosbag, folder: lab}}, {{name: json_lines, address: '127.0.0.1:1'}}]\n")
    before = set(Path().iterdir())
    with pytest.raises(irsim.IrsimError, match="no program listens"):
        irsim.connect(env)
    assert set(Path().iterdir()) == before


def test_all_messages_of_a_scene_have_equal_bytes(make_env: MakeEnv) -> None:
    from irsim.bridges.ros.backends.dds import struct_type

    env = make_env(SENSING)
    for _ in range(3):
        env.step()
    scene, state = describe_scene(env.simulation), world_state(env.simulation, agent_rows(env.simulation))
    messages = Messages()
    topics = scene_topics(scene, scene.robots, "sim", names={}, qos={})
    outgoing = Outgoing(messages, scene, topics, "map", "sim")
    seen = set()
    for topic, message in [*outgoing.once(5), *outgoing.step(state)]:
        made = struct_type(messages.store, topic.kind)
        ours = messages.cdr(message, topic.kind)
        theirs = made.deserialize(ours).serialize(use_version_2=False)
        # the header may say how many bytes of padding follow
        assert theirs[:2] == ours[:2]
        assert theirs[4:].rstrip(b"\0") == ours[4:].rstrip(b"\0"), topic
        seen.add(topic.key)
    assert seen == {key for key, row in TABLE.items() if row.sim == "out"}


@pytest.mark.parametrize("distro", ["humble", "jazzy"])
def test_identifiers_have_the_length_of_the_release(distro: Any) -> None:
    from irsim.bridges.ros.backends.dds import dds_type_name

    messages = Messages(distro)
    [(_, (_, detail))] = messages.store.fielddefs["rmw_dds_common/msg/Gid"][1]
    assert detail[1] == messages.gid_size
    assert dds_type_name("geometry_msgs/msg/Twist") == "geometry_msgs::msg::dds_::Twist_"
