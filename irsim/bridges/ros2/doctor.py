"""What ``irsim bridge doctor`` says of ROS 2: two nodes on this computer hear each other."""

from __future__ import annotations

import os
import socket
from functools import partial

from irsim.bridges.doctor import Part
from irsim.bridges.ros.selftest import two_nodes
from irsim.components.bridges.ros2 import Ros2

__all__ = ["PARTS"]

_DOMAINS = 60
"""Domains above 40 of which the test takes one, so that it meets no robot."""


def _dds() -> str:
    domain = 41 + os.getpid() % _DOMAINS
    return two_nodes(*(Ros2(backend="dds", loopback=True, domain=domain) for _ in range(2)))


def _zenoh() -> str:
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = f"127.0.0.1:{server.getsockname()[1]}"
    made = partial(Ros2, backend="zenoh", address=address)
    return two_nodes(made(router=True), made())


PARTS = (
    Part("rclpy", None, "source /opt/ros/$ROS_DISTRO/setup.bash"),
    Part("cyclonedds", "cyclonedds", "ros2", _dds),
    Part("zenoh", "eclipse-zenoh", "zenoh", _zenoh),
)
"""The libraries of the bridge: one of them is enough."""
