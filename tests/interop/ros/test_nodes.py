"""Our nodes of ROS 1, with roscore and rospy, and of Zenoh, with zenoh-ros2-sdk, whose keys and hashes are its own."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

import irsim
from irsim.bridges.ros.messages import Messages
from tests.interop.ros.conftest import HERE, PYTHON, SCENE, MakeEnv, Start, free_port

pytestmark = [
    pytest.mark.interop,
    pytest.mark.xdist_group("ros_others"),
    # rospy and what it needs leave sockets to the collector of garbage
    pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::pytest.PytestUnraisableExceptionWarning"),
]


def test_both_ways_with_a_node_of_ros_1(master: str, start: Start, make_env: MakeEnv) -> None:
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
    assert peer.on("markers") == ["4"]  # the first clears those before


def test_without_a_master_the_error_says_so(make_env: MakeEnv, monkeypatch: pytest.MonkeyPatch) -> None:
    env = make_env(f"{SCENE}bridges: [{{name: ros1, master: 'http://127.0.0.1:{free_port()}'}}]\n")
    with pytest.raises(irsim.bridges.base.BridgeError, match=r"no ROS master answers at .*start roscore"):
        irsim.connect(env)
    assert "roscore" not in os.environ.get("ROS_MASTER_URI", "")


@pytest.fixture
def definitions() -> Path:
    """Definitions of messages as files, of which the peer makes its own types and hashes."""
    store, folder = Messages().store, Path("messages").absolute()
    for kind in store.fielddefs:
        package, space, name = kind.split("/")
        text, _ = store.generate_msgdef(kind, ros_version=2)
        target = folder / package / space / f"{name}.msg"
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text.split("=" * 80)[0])
    return folder


def test_both_ways_with_a_node_that_others_list(
    start: Start, domain: int, definitions: Path, make_env: MakeEnv
) -> None:
    port = free_port()
    options = f"{{name: ros2, backend: zenoh, router: true, address: '127.0.0.1:{port}', domain: {domain}}}"
    env = make_env(f"{SCENE}bridges: [{options}]\n")
    with irsim.connect(env):
        peer = start(PYTHON, str(HERE / "zenoh_peer.py"), str(definitions), str(port), str(domain), "60")
        for _ in range(600):
            env.step()
            if len(peer.on("scan")) >= 60 and peer.on("map") and float(env.robot.state[0, 0]) > 1.3:
                break
        velocity = env.robot.velocity[:2, 0].tolist()
        command = [str(Path(PYTHON).parent / "zenoh-ros2"), "--domain-id", str(domain), "--router", f"127.0.0.1:{port}"]
        command += ["--no-daemon", "topic", "info", "/robot_0/scan", "-v"]
        listed = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert velocity == pytest.approx([0.4, 0.5])
    assert len(peer.on("pose")) >= 50
    assert set(peer.on("scan")) == {"90"}
    assert peer.on("map") == ["20 10"]  # latched: it was put before the peer was there
    assert "irsim_bridge" in listed.stdout, listed
    assert "sensor_msgs/msg/LaserScan" in listed.stdout
