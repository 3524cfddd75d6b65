"""Bags that we write, read by rosbags and by mcap-ros2-support, which decodes CDR by itself."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.runs import open_run
from tests.interop.ros.conftest import SCENE

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("ros_others")]


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
def test_a_recorded_run_as_a_bag(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, storage: str) -> None:
    monkeypatch.chdir(tmp_path)
    run = open_run(str(irsim.run(text=SCENE, seed=3, steps=30, record=True).run_id))
    irsim.export_run(run, "bag-rosbag2", to="rosbag2", options={"storage": storage})
    folder = tmp_path / "bag-rosbag2"
    assert sorted(path.name for path in folder.iterdir()) == [
        f"bag-rosbag2.{'db3' if storage == 'sqlite3' else 'mcap'}", "metadata.yaml",
    ]  # fmt: skip
    trace = run.trace()
    by_topic = by_rosbags(folder)
    for number, message in enumerate(by_topic["/robot_0/odom"]):
        assert message.pose.pose.position.x == trace.pose[number, 0, 0]
    np.testing.assert_array_equal(by_topic["/robot_0/scan"][7].ranges, trace.ranges["robot_0/0"][7])
    assert "robot_0" in (folder / "metadata.yaml").read_text()  # the scenario
    if storage == "mcap":
        again = by_mcap(folder)
        assert {topic: len(messages) for topic, messages in again.items()} == {
            topic: len(messages) for topic, messages in by_topic.items()
        }
        assert again["/robot_0/odom"][5].pose.pose.position.x == trace.pose[5, 0, 0]


def test_a_bag_that_is_recorded_while_running(
    make_env: Callable[[str], Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    env = make_env(f"{SCENE}bridges: [{{name: rosbag, folder: lab}}]\n")
    xs = []
    with irsim.connect(env):
        for _ in range(20):
            env.step()
            xs.append(float(env.robot.state[0, 0]))
        assert not (tmp_path / "lab").exists()  # only a complete bag has its name
    for by_topic in (by_rosbags(tmp_path / "lab"), by_mcap(tmp_path / "lab")):
        assert [one.pose.position.x for one in by_topic["/robot_0/pose"][1:]] == xs
        assert len(by_topic["/clock"]) == 21
        assert len(by_topic["/map"]) == 1
    assert [path.name for path in (tmp_path / "lab").iterdir() if path.name.startswith(".")] == []


def test_a_run_that_does_not_begin_leaves_no_bag(
    make_env: Callable[[str], Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    env = make_env(f"{SCENE}bridges: [{{name: rosbag, folder: lab}}, {{name: json_lines, address: '127.0.0.1:1'}}]\n")
    before = set(tmp_path.iterdir())
    with pytest.raises(irsim.IrsimError, match="no program listens"):
        irsim.connect(env)
    assert set(tmp_path.iterdir()) == before
