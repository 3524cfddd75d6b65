"""``rospy``: a node of ROS 1."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from irsim.bridges.base import BridgeError, BridgeLostError
from irsim.bridges.ros.backends.base import Backend, Node, message_class
from irsim.bridges.ros.topics import Topic

__all__ = ["RospyBackend", "find_rospy"]

_DEBIAN = Path("/usr/lib/python3/dist-packages")
"""Where packages of Debian and Ubuntu install rospy for the Python of the system."""
_APT = "python3-{}"
_QUEUE = 10


def find_rospy() -> bool:
    """Whether rospy can be imported; a virtual environment finds Debian's, too, after all other packages."""
    if find_spec("rospy") is None and (_DEBIAN / "rospy").is_dir() and str(_DEBIAN) not in sys.path:
        sys.path.append(str(_DEBIAN))
    return find_spec("rospy") is not None


class RospyBackend(Backend):
    """A node of rospy; a process can have one name of a node only, which later bridges share.

    Args:
        node: The node.
        master: Address of the master; None takes ``ROS_MASTER_URI``.
    """

    def __init__(self, node: Node, *, master: str | None) -> None:
        if not find_rospy():
            what = "rospy cannot be imported"
            fix = "source the setup.bash of ROS 1, or on Debian 12: apt install ros-base python3-rospy python3-nav-msgs"
            raise BridgeError("bridge-failed", what, fix)
        super().__init__(node)
        self._rospy: Any = import_module("rospy")
        rosgraph: Any = import_module("rosgraph")
        address = master or rosgraph.get_master_uri()
        if not rosgraph.Master(f"/{self.node}", master_uri=address).is_online():
            fix = "start roscore, or set master: http://HOST:11311"
            raise BridgeLostError(f"no ROS master answers at {address}", fix)
        self.peer = f"the ROS master at {address}"
        self._publishers: dict[Topic, Any] = {}
        self._subscribers: list[Any] = []
        if not self._rospy.core.is_initialized():
            if master is not None:
                os.environ["ROS_MASTER_URI"] = master
            self._rospy.init_node(self.node, anonymous=True, disable_signals=True, disable_rosout=True)
        for topic in self.topics:
            kind = message_class(topic.kind, _APT)
            if topic.outgoing:
                latch = topic.qos.latched
                self._publishers[topic] = self._rospy.Publisher(topic.name, kind, queue_size=_QUEUE, latch=latch)
            else:
                put: Callable[[Any], None] = partial(self.inbox.put, topic)
                self._subscribers.append(self._rospy.Subscriber(topic.name, kind, put, queue_size=1))

    def publish(self, topic: Topic, message: Any) -> None:
        """Publish a message."""
        publisher = self._publishers[topic]
        publisher.publish(_filled(publisher.data_class(), message))

    def close(self) -> None:
        """Leave all topics; the node itself ends with the process."""
        for one in (*self._publishers.values(), *self._subscribers):
            one.unregister()
        self._publishers, self._subscribers = {}, []


def _filled(target: Any, source: Any) -> Any:
    """A message of ROS 1 with the values of one of ROS 2; what only one of them has, stays as it is."""
    if hasattr(target, "secs"):
        target.secs, target.nsecs = source.sec, source.nanosec
        return target
    for name, kind in zip(target.__slots__, target._slot_types, strict=True):
        if not hasattr(source, name):
            continue
        value = getattr(source, name)
        if isinstance(value, list):
            inner = message_class(kind.partition("[")[0].replace("/", "/msg/"), _APT)
            setattr(target, name, [_filled(inner(), one) for one in value])
        elif hasattr(value, "__dataclass_fields__"):
            setattr(target, name, _filled(getattr(target, name), value))
        else:
            setattr(target, name, value.tolist() if hasattr(value, "tolist") else value)
    return target
