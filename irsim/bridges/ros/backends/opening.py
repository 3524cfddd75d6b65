"""From options to a backend."""

from __future__ import annotations

import os
from importlib.util import find_spec
from pathlib import Path
from typing import TypeAlias

from irsim.bridges.base import BridgeError
from irsim.bridges.ros.backends.base import Backend, Node
from irsim.bridges.ros.messages import Messages
from irsim.components.bridges.ros1 import Ros1
from irsim.components.bridges.ros2 import Ros2
from irsim.components.bridges.rosbag import Rosbag
from irsim.components.bridges.rosbridge import Rosbridge

__all__ = ["AnyOptions", "make_messages", "open_backend"]

AnyOptions: TypeAlias = Ros2 | Ros1 | Rosbridge | Rosbag
_MAX_DOMAIN = 101
"""Highest number of a domain whose ports are free on all systems."""


def make_messages(options: AnyOptions) -> Messages:
    """The messages of a bridge."""
    if isinstance(options, Ros2):
        return Messages(options.distro, "zenoh" if options.backend == "zenoh" else "ros2")
    return Messages(extra="rosbridge" if isinstance(options, Rosbridge) else "bag")


def open_backend(options: AnyOptions, node: Node) -> Backend:
    """Connect a node.

    Args:
        options: Options of the bridge.
        node: The node.

    Raises:
        BridgeError: The other side cannot be reached.
        ExtraError: A library is missing.
    """
    if isinstance(options, Rosbag):
        from irsim.bridges.ros.backends.bag import BagBackend

        return BagBackend(node, folder=Path(options.folder), storage=options.storage)
    if isinstance(options, Rosbridge):
        from irsim.bridges.ros.backends.rosbridge import RosbridgeBackend

        return RosbridgeBackend(node, options)
    if isinstance(options, Ros1):
        from irsim.bridges.ros.backends.rospy_node import RospyBackend

        return RospyBackend(node, master=options.master)
    return _ros2(options, node)


def _ros2(options: Ros2, node: Node) -> Backend:
    backend = options.backend
    if backend == "auto":
        backend = "rclpy" if find_spec("rclpy") is not None else "dds"
    if backend == "rclpy":
        if find_spec("rclpy") is None:
            fix = "source /opt/ros/$ROS_DISTRO/setup.bash, or write backend: dds, which needs no ROS"
            raise BridgeError("bridge-failed", "rclpy cannot be imported", fix)
        from irsim.bridges.ros.backends.rclpy_node import RclpyBackend

        return RclpyBackend(node, domain=options.domain)
    domain = _environment_domain() if options.domain is None else options.domain
    if backend == "zenoh":
        from irsim.bridges.ros.backends.zenoh import ZenohBackend

        return ZenohBackend(node, options, domain=domain)
    from irsim.bridges.ros.backends.dds import DdsBackend

    return DdsBackend(node, domain=domain, loopback=options.loopback or _stays_here())


def _stays_here() -> bool:
    """Whether the variables of ROS 2 say that nodes speak to those on this computer only."""
    result = os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "").upper() in ("LOCALHOST", "OFF")
    return result or os.environ.get("ROS_LOCALHOST_ONLY") == "1"


def _environment_domain() -> int:
    text = os.environ.get("ROS_DOMAIN_ID", "") or "0"
    if not text.isdigit() or int(text) > _MAX_DOMAIN:
        what = f"ROS_DOMAIN_ID is {text!r}, not a whole number from 0 to {_MAX_DOMAIN}"
        raise BridgeError("bridge-failed", what, "export ROS_DOMAIN_ID=0")
    return int(text)
