"""Our Zenoh node against zenoh-ros2-sdk, which has its own rmw_zenoh keys, hashes and attachments."""

from __future__ import annotations

import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import irsim
from irsim.bridges.ros.messages import Messages
from tests.interop.ros.conftest import HERE, PYTHON, SCENE, Peer

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("ros_others")]


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as server:
        return int(server.getsockname()[1])


@pytest.fixture
def definitions(tmp_path: Path) -> Path:
    """Definitions of messages as files, of which the peer makes its own types and hashes."""
    store = Messages().store
    folder = tmp_path / "messages"
    for kind in store.fielddefs:
        package, space, name = kind.split("/")
        text, _ = store.generate_msgdef(kind, ros_version=2)
        target = folder / package / space / f"{name}.msg"
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text.split("=" * 80)[0])
    return folder


def test_both_ways_with_a_node_that_others_list(
    start: Callable[..., Peer], domain: int, definitions: Path, make_env: Callable[[str], Any]
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
        listed = subprocess.run(
            [str(Path(sys.executable).parent / "zenoh-ros2"), "--domain-id", str(domain), "--router",
             f"127.0.0.1:{port}", "--no-daemon",
             "topic", "info", "/robot_0/scan", "-v"],
            capture_output=True, text=True, check=False, timeout=60,
        )  # fmt: skip
    assert velocity == pytest.approx([0.4, 0.5])
    assert len(peer.on("pose")) >= 50
    assert set(peer.on("scan")) == {"90"}
    assert peer.on("map") == ["20 10"]  # latched: it was put before the peer was there
    assert "irsim_bridge" in listed.stdout, listed
    assert "sensor_msgs/msg/LaserScan" in listed.stdout
