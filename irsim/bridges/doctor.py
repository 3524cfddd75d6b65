"""Which bridges can be used on this machine, tested over the loopback where that is possible."""

from __future__ import annotations

import math
import os
import socket
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, field, replace
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from typing import Literal

import numpy as np

from irsim.bridges.carla.client import NEWEST_PYTHON
from irsim.bridges.carla.places import Places
from irsim.bridges.ros.backends.bag import BagFolder
from irsim.bridges.ros.backends.base import Node
from irsim.bridges.ros.backends.opening import make_messages, open_backend
from irsim.bridges.ros.backends.rospy_node import find_rospy
from irsim.bridges.ros.incoming import Inbox, decode, read_twist
from irsim.bridges.ros.messages import Messages
from irsim.bridges.ros.topics import STATE, Topic
from irsim.components.bridges.ros2 import Ros2
from irsim.options.registry import BRIDGES

__all__ = ["LEFT_CURVE", "PARTS", "Health", "Part", "examine"]


@dataclass(frozen=True)
class Part:
    """A library of a bridge.

    Attributes:
        module: Its top-level module.
        package: Its name in the package registry; None if it comes with a system, such as ROS.
        extra: The extra of ``irsim-mcp`` that installs it, or how it is installed.
        self_test: Function that uses it on this machine alone, and returns one sentence; None without one.
    """

    module: str
    package: str | None
    extra: str
    self_test: Callable[[], str] | None = None


@dataclass(frozen=True)
class Health:
    """State of a bridge, or of one of its backends.

    Attributes:
        bridge: Name of the bridge.
        part: Name of the library; empty for a bridge that needs no library.
        state: ``ready`` (its test passed), ``there`` (it has no test), ``missing`` or ``broken``.
        version: Version of the library, or empty.
        text: A sentence on what the test did or what failed, or the command that installs the library.
    """

    bridge: str
    part: str
    state: Literal["ready", "there", "missing", "broken"]
    version: str = ""
    text: str = field(default="")


def examine(names: Sequence[str] = ()) -> list[Health]:
    """Look at bridges: which libraries are there, and whether they work on this machine.

    Args:
        names: Names of bridges; default: all.
    """
    result = []
    for name in names or BRIDGES.names():
        feature = BRIDGES.get(name)
        if feature is None:
            result.append(
                Health(name, "", "missing", text=f"there is no such bridge; they are {', '.join(BRIDGES.names())}")
            )
            continue
        result += [_look(name, part) for part in PARTS.get(name, ())] or [
            Health(name, "", "there", text="it needs no library")
        ]
    return result


def _look(name: str, part: Part) -> Health:
    if not _exists(part.module):
        how = f"pip install 'irsim-mcp[{part.extra}]'" if part.package is not None else part.extra
        return Health(name, part.module, "missing", text=how)
    number = ""
    if part.package is not None:
        try:
            number = version(part.package)
        except PackageNotFoundError:
            number = "?"
    if part.self_test is None:
        return Health(name, part.module, "there", number)
    try:
        return Health(name, part.module, "ready", number, part.self_test())
    except Exception as error:  # a third-party library may raise anything; that is what is examined
        return Health(name, part.module, "broken", number, f"{type(error).__name__}: {error}")


def _exists(module: str) -> bool:
    try:
        return find_spec(module) is not None
    except ModuleNotFoundError:
        return False


_LENGTH, _CURVATURE = 20.0, 0.05
LEFT_CURVE = f"""<?xml version="1.0"?>
<OpenDRIVE>
  <header revMajor="1" revMinor="4" name="curve" version="1" north="0" south="0" east="0" west="0">
    <geoReference><![CDATA[+proj=tmerc +lat_0=0 +lon_0=0]]></geoReference>
  </header>
  <road name="curve" length="{_LENGTH}" id="1" junction="-1">
    <link/>
    <planView>
      <geometry s="0" x="0" y="0" hdg="0" length="{_LENGTH}"><arc curvature="{_CURVATURE}"/></geometry>
    </planView>
    <elevationProfile><elevation s="0" a="0" b="0" c="0" d="0"/></elevationProfile>
    <lateralProfile/>
    <lanes>
      <laneSection s="0">
        <center><lane id="0" type="none" level="false"/></center>
        <right>
          <lane id="-1" type="driving" level="false"><link/><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane>
        </right>
      </laneSection>
    </lanes>
  </road>
</OpenDRIVE>
"""
"""A road of OpenDRIVE that turns left, in the frame of irsim."""


def _follow_curve() -> str:
    """Follow the road in the client and in irsim."""
    import carla

    road = carla.Map("curve", LEFT_CURVE)
    angle, radius = _LENGTH / 2 * _CURVATURE, 1 / _CURVATURE + 1.75  # the lane is to the right of the arc
    middle = np.array([radius * math.sin(angle), 1 / _CURVATURE - radius * math.cos(angle), angle])
    at = road.get_waypoint_xodr(1, -1, _LENGTH / 2).transform
    there = Places().to_irsim(np.array([at.location.x, at.location.y, at.rotation.yaw]))
    if not np.allclose(there, middle, atol=0.05):
        raise ValueError(f"the middle of a left curve is at {there.round(2).tolist()}, not {middle.round(2).tolist()}")
    return "the client reads a road, whose left curve is where irsim has it; a server was not asked"


def _loopback() -> str:
    """Send a line to this machine."""
    with (
        socket.create_server(("127.0.0.1", 0)) as server,
        socket.create_connection(server.getsockname(), timeout=5) as sender,
    ):
        sender.sendall(b"{}\n")
        receiver, _ = server.accept()
        with receiver, receiver.makefile("rb") as lines:
            if lines.readline() != b"{}\n":
                raise OSError("what was sent did not arrive")
    return "a line crossed a TCP connection of this machine"


def _fall() -> str:
    """Let a ball fall for a tenth of a second, and compare with the law of falling bodies."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body><freejoint/><geom size="0.1"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    while data.time < 0.1 - 1e-9:
        mujoco.mj_step(model, data)
    fallen = -float(data.qpos[2])
    if not abs(fallen - 0.04905) < 0.002:
        raise RuntimeError(f"a ball fell {fallen:.4f} m in 0.1 s instead of 0.0490 m")
    return f"a ball fell {fallen:.3f} m in 0.1 s"


_WAIT_S = 10.0
_TWIST = Topic("cmd_vel", "/irsim_doctor/cmd_vel", "geometry_msgs/msg/Twist", True, STATE)


def _two_nodes(first: Ros2, second: Ros2) -> str:
    """Send a command from one node to another one.

    Returns:
        A sentence about it.

    Raises:
        TimeoutError: It did not come.
    """
    messages, inbox, heard = make_messages(first), Inbox(), replace(_TWIST, outgoing=False)
    one, other = Node("irsim_doctor", [_TWIST], Inbox(), messages), Node("irsim_doctor_too", [heard], inbox, messages)
    with ExitStack() as nodes:
        sender = nodes.enter_context(closing(open_backend(first, one)))
        receiver = nodes.enter_context(closing(open_backend(second, other)))
        began = time.monotonic()
        while time.monotonic() - began < _WAIT_S:
            sender.publish(_TWIST, messages.twist(0.5, 0.0, 1.0))
            time.sleep(0.02)
            receiver.poll()
            for topic, arrival in inbox.take().items():
                if read_twist(decode(messages, topic, arrival.content)) == (0.5, 0.0, 1.0):
                    return f"a command went from a node to another one after {time.monotonic() - began:.1f} s"
    raise TimeoutError(f"a node did not hear another one on this computer within {_WAIT_S:g} s")


_DOMAINS = 60
"""Domains above 40 of which the test takes one, so that it meets no robot."""


def _dds() -> str:
    """Let two participants of DDS hear each other."""
    domain = 41 + os.getpid() % _DOMAINS
    return _two_nodes(*(Ros2(backend="dds", loopback=True, domain=domain) for _ in range(2)))


def _zenoh() -> str:
    """Let two sessions of Zenoh hear each other."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = f"127.0.0.1:{server.getsockname()[1]}"
    made = partial(Ros2, backend="zenoh", address=address)
    return _two_nodes(made(router=True), made())


def _write_and_read() -> str:
    """Write a bag, and read it again."""
    from rosbags.rosbag2 import Reader

    messages = Messages()
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder) / "bag"
        with BagFolder(bag, messages, "mcap", "bag") as file:
            topic = file.topic("/cmd_vel", "geometry_msgs/msg/Twist")
            file.add(topic, 1, messages.twist(0.5, 0.0, 1.0))
        with Reader(bag) as reader:
            [(_, _, content)] = reader.messages()
        return f"a bag was written and read again ({len(content)} bytes of a message)"


find_rospy()
_NO_CARLA = "CARLA has no client for this Python: use Python 3.10 to 3.12, then pip install 'irsim-mcp[carla]'"
_BAGS = Part("rosbags", "rosbags", "bag", _write_and_read)
PARTS: dict[str, tuple[Part, ...]] = {
    "carla": (
        Part("carla", "carla", "carla", _follow_curve)
        if sys.version_info[:2] <= NEWEST_PYTHON
        else Part("carla", None, _NO_CARLA),
    ),
    "json_lines": (Part("socket", None, "part of Python", _loopback),),
    "mujoco": (Part("mujoco", "mujoco", "mujoco", _fall),),
    "ros1": (
        Part("rospy", None, "source the setup.bash of ROS 1, or on Debian 12: apt install ros-base python3-rospy"),
        replace(_BAGS, self_test=None),
    ),
    "ros2": (
        Part("rclpy", None, "source /opt/ros/$ROS_DISTRO/setup.bash"),
        Part("cyclonedds", "cyclonedds", "ros2", _dds),
        Part("zenoh", "eclipse-zenoh", "zenoh", _zenoh),
    ),
    "rosbag": (_BAGS,),
    "rosbridge": (Part("roslibpy", "roslibpy", "rosbridge"),),
}
"""The libraries of each bridge; for ``ros2`` one of them is enough."""
