"""Our node of ROS 1 with roscore and a node of rospy, each in its own process."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable
from typing import Any

import pytest

import irsim
from tests.interop.ros.conftest import HERE, PYTHON, SCENE, Peer, free_port

pytestmark = [
    pytest.mark.interop,
    pytest.mark.xdist_group("ros_others"),
    # rospy and what it needs leave sockets to the collector of garbage
    pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::pytest.PytestUnraisableExceptionWarning"),
]


def test_both_ways_with_a_node_of_ros_1(
    master: str, start: Callable[..., Peer], make_env: Callable[[str], Any]
) -> None:
    env = make_env(f"{SCENE}bridges: [{{name: ros1, master: '{master}'}}]\n")
    with irsim.connect(env):
        for _ in range(10):
            env.step()
        peer = start(PYTHON, str(HERE / "rospy_peer.py"), "60")
        for _ in range(600):
            env.step()
            if len(peer.on("scan")) >= 60 and float(env.robot.state[0, 0]) > 1.3:
                break
        velocity, goal = env.robot.velocity[:2, 0].tolist(), env.robot.goal[:2, 0].tolist()
        listed = subprocess.run(["/usr/bin/rostopic", "list", "-v"], capture_output=True, text=True, check=True)
    assert velocity == pytest.approx([0.4, 0.5])
    assert goal == [3, 0]
    assert "/robot_0/scan [sensor_msgs/LaserScan] 1 publisher" in listed.stdout
    assert len(peer.on("odom")) >= 50
    assert peer.on("odom")[-1].endswith(" map")
    assert {one.split()[0] for one in peer.on("scan")} == {"90"}
    assert any(one.endswith("inf") for one in peer.on("scan"))
    assert set(peer.on("tf")) == {"robot_0/base_link"}
    assert peer.on("map") == ["20 10"]  # latched
    assert peer.on("markers") == ["3"]


def test_without_a_master_the_error_says_so(make_env: Callable[[str], Any], monkeypatch: pytest.MonkeyPatch) -> None:
    env = make_env(f"{SCENE}bridges: [{{name: ros1, master: 'http://127.0.0.1:{free_port()}'}}]\n")
    with pytest.raises(irsim.bridges.base.BridgeError, match=r"no ROS master answers at .*start roscore"):
        irsim.connect(env)
    assert "roscore" not in os.environ.get("ROS_MASTER_URI", "")
