"""Our node without ROS against a peer on Fast DDS, the default middleware of ROS 2."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import irsim
from irsim.bridges.ros.backends.base import Backend
from irsim.bridges.ros.messages import Messages
from tests.interop.ros.conftest import SCENE, Peer, until

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("fastdds")]
TOPICS = {
    "/robot_0/odom": "nav_msgs/msg/Odometry",
    "/robot_0/pose": "geometry_msgs/msg/PoseStamped",
    "/robot_0/scan": "sensor_msgs/msg/LaserScan",
    "/robot_0/reference_path": "nav_msgs/msg/Path",
    "/pedestrians": "geometry_msgs/msg/PoseArray",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/map": "nav_msgs/msg/OccupancyGrid",
    "/irsim/markers": "visualization_msgs/msg/MarkerArray",
}


def bridge(domain: int, **more: Any) -> str:
    options = {"name": "ros2", "backend": "dds", "loopback": "true", "domain": domain, **more}
    return f"bridges: [{{{', '.join(f'{key}: {value}' for key, value in options.items())}}}]\n"


@pytest.fixture
def published(monkeypatch: pytest.MonkeyPatch) -> dict[str, set[str]]:
    """CDR of all that we publish, by topic."""
    from irsim.bridges.ros.backends.dds import DdsBackend

    samples: dict[str, set[str]] = {}
    publish = DdsBackend.publish

    def recorded(self: Backend, topic: Any, message: Any) -> None:
        samples.setdefault(topic.name, set()).add(self.messages.cdr(message, topic.kind).hex())
        publish(self, topic, message)  # type: ignore[arg-type]

    monkeypatch.setattr(DdsBackend, "publish", recorded)
    return samples


def test_both_ways_and_the_same_bytes(
    fastdds_program: str,
    start: Callable[..., Peer],
    domain: int,
    published: dict[str, set[str]],
    make_env: Callable[[str], Any],
) -> None:
    peer = start(fastdds_program, str(domain), "30", "0.4", "0.5")
    env = make_env(SCENE + bridge(domain))
    with irsim.connect(env):
        for _ in range(400):
            env.step()
            if len(peer.on("/robot_0/scan")) >= 60 and float(env.robot.state[0, 0]) > 1.3:
                break
        velocity = env.robot.velocity[:2, 0].tolist()
        goal = env.robot.goal[:2, 0].tolist()
    assert velocity == pytest.approx([0.4, 0.5])  # the robot has no behavior: it follows the peer
    assert goal == [3, 2]
    for topic in TOPICS:
        heard = peer.on(topic)
        assert len(heard) >= (1 if topic in ("/map", "/irsim/markers") else 50), topic
        # what Fast CDR writes of what it has read is what we have written
        assert {_trimmed(one) for one in heard} <= {_trimmed(one) for one in published[topic]}, topic
    messages = Messages()
    last = messages.from_cdr(bytes.fromhex(peer.on("/robot_0/scan")[-1]), TOPICS["/robot_0/scan"])
    assert len(last.ranges) == 90
    path = messages.from_cdr(bytes.fromhex(peer.on("/robot_0/reference_path")[-1]), TOPICS["/robot_0/reference_path"])
    assert [path.poses[-1].pose.position.x, path.poses[-1].pose.position.y] == goal  # it leads to the goal of the peer


def _trimmed(text: str) -> str:
    """CDR without the flag of padding in its header and the padding itself, which each side may choose."""
    return text[8:].rstrip("0")


def test_who_comes_late_gets_the_map(
    fastdds_program: str,
    start: Callable[..., Peer],
    domain: int,
    published: dict[str, set[str]],
    make_env: Callable[[str], Any],
) -> None:
    env = make_env(SCENE + bridge(domain))
    with irsim.connect(env):
        for _ in range(20):
            env.step()
        peer = start(fastdds_program, str(domain), "20", "0", "0", "silent")
        until(lambda: peer.on("/map") and peer.on("/irsim/markers"), 10, "no map")
        for _ in range(10):
            env.step()
    assert len(peer.on("/map")) == 1
    messages = Messages()
    grid = messages.from_cdr(bytes.fromhex(peer.on("/map")[0]), TOPICS["/map"])
    assert (grid.info.width, grid.info.height, grid.info.resolution) == (20, 10, 0.5)
    assert grid.header.frame_id == "map"
    assert {0, 100} == set(grid.data.tolist())
