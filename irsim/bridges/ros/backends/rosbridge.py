"""``rosbridge``: a client of rosbridge_server, which reaches ROS 1 and ROS 2 over one TCP port with JSON."""

# ruff: noqa: E402  # the library is asked for first
from __future__ import annotations

import time
from collections.abc import Mapping
from contextlib import suppress
from functools import partial
from types import SimpleNamespace
from typing import Any

from irsim.bridges.base import BridgeLostError
from irsim.bridges.ros.backends.base import Backend, Node
from irsim.bridges.ros.topics import Topic
from irsim.common.extras import require
from irsim.components.bridges.rosbridge import Rosbridge

require("rosbridge", "roslibpy", "rosbags")
import roslibpy
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

__all__ = ["RosbridgeBackend", "namespaces", "plain"]

_ADVERTISE_S = 0.5
"""Time in which roslibpy advertises all topics anew after the connection was made again."""
_RETRY_S = 2.0
"""Longest time between two attempts to find a server again."""
_CLOSE_S = 2.0
"""Time for which to wait for the server when the connection is closed."""


class RosbridgeBackend(Backend):
    """A connection to rosbridge_server.

    Args:
        node: The node, whose name the server does not show.
        options: Where the server is, the version of ROS behind it, and how long to wait for it, also if the connection
            breaks.
    """

    def __init__(self, node: Node, options: Rosbridge) -> None:
        super().__init__(node)
        host, port, ros, timeout = options.host, options.port, options.ros, options.timeout
        self._address, self._timeout, self._ros_version = f"{host}:{port}", timeout, ros
        self.peer = f"the rosbridge server at {self._address} (ROS {ros})"
        self._store = self.messages.store if ros == 2 else _definitions_of_ros1()
        self._gone: float | None = None
        self._connected, self._again = False, 0.0
        self._latched: dict[Topic, Any] = {}
        self._publishers: dict[Topic, Any] = {}
        self._subscribers: list[Any] = []
        self._client = roslibpy.Ros(host=f"[{host}]" if ":" in host else host, port=port, transport="asyncio")
        self._client.factory.on("ready", self._listen)
        self._client.factory.maxDelay = _RETRY_S
        try:
            self._client.run(timeout=timeout)
        except roslibpy.core.RosTimeoutError:
            self._end()
            what = f"no rosbridge server answers at {self._address} within {timeout:g} s"
            start = "ros2 launch rosbridge_server rosbridge_websocket_launch.xml"
            if ros == 1:
                start = "roslaunch rosbridge_server rosbridge_websocket.launch"
            raise BridgeLostError(what, f"start it on the robot: {start}; or name another host and port") from None
        for topic in self.topics:
            kind = topic.kind if ros == 2 else topic.kind.replace("/msg/", "/")
            channel = roslibpy.Topic(
                self._client, topic.name, kind, latch=topic.qos.latched, queue_size=topic.qos.depth, queue_length=1
            )
            if topic.outgoing:
                channel.advertise()
                self._publishers[topic] = channel
            else:
                channel.subscribe(partial(self._received, topic))
                self._subscribers.append(channel)

    @property
    def ready(self) -> bool:
        """Whether the server is there and knows the topics."""
        return bool(self._client.is_connected) and time.monotonic() >= self._again

    def publish(self, topic: Topic, message: Any) -> None:
        """Send a message as JSON; without a connection it is dropped, so that none is sent when it is old."""
        self._check()
        content = plain(message, topic.kind, self._store, self._ros_version)
        if topic.qos.latched:
            self._latched[topic] = content
        if not self.ready:
            return
        if self._again:  # the server has lost what it had kept for those who subscribe later
            self._again = 0.0
            for other, kept in self._latched.items():
                if other != topic:
                    self._publishers[other].publish(kept)
        self._publishers[topic].publish(content)

    def poll(self) -> None:
        """Notice that the server is gone; messages come in a thread of roslibpy."""
        self._check()

    def close(self) -> None:
        """Leave all topics and disconnect."""
        if self._client is None:
            return
        if self._client.is_connected:
            for channel in self._publishers.values():
                channel.unadvertise()
            for channel in self._subscribers:
                channel.unsubscribe()
        self._publishers, self._subscribers = {}, []
        self._end()

    def _listen(self, protocol: Any) -> None:
        """Take what the server says of errors, for each connection anew; roslibpy has no other way to it."""
        protocol._message_handlers["status"] = self._told
        if self._connected:
            self._again = time.monotonic() + _ADVERTISE_S
        self._connected = True

    def _told(self, status: Mapping[str, Any]) -> None:
        if status.get("level") in ("error", "warning"):
            self.inbox.tell(f"the server says: {status.get('msg')}")

    def _received(self, topic: Topic, message: Mapping[str, Any]) -> None:
        self.inbox.put(topic, namespaces(dict(message)))

    def _check(self) -> None:
        if self._client.is_connected:
            self._gone = None
            return
        now = time.monotonic()
        self._gone = now if self._gone is None else self._gone
        if now - self._gone > self._timeout:
            raise BridgeLostError(f"the connection to the rosbridge server at {self._address} is lost")

    def _end(self) -> None:
        client, self._client = self._client, None
        with suppress(Exception):  # the connection may be gone already, in whatever way
            client.close(timeout=_CLOSE_S)
        until = time.monotonic() + _CLOSE_S
        while client.is_connected and time.monotonic() < until:  # so that the last messages go out
            time.sleep(0.01)
        time.sleep(0.05)
        client.terminate()


def _definitions_of_ros1() -> Any:
    """Type store with the definitions of Noetic."""
    store = get_typestore(Stores.ROS1_NOETIC)
    kind = "tf2_msgs/msg/TFMessage"  # which rosbags leaves out
    store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", kind))
    return store


def plain(message: Any, kind: str, store: Any, ros: int) -> dict[str, Any]:
    """A message as rosbridge writes it in JSON, with the fields that its definition in a store has."""
    if kind in ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration"):
        seconds, nanoseconds = ("sec", "nanosec") if ros == 2 else ("secs", "nsecs")
        return {seconds: int(message.sec), nanoseconds: int(message.nanosec)}
    _, fields = store.fielddefs[kind]
    result: dict[str, Any] = {}
    for name, (form, detail) in fields:
        if not hasattr(message, name):  # such as ``seq`` of headers in ROS 1
            continue
        value = getattr(message, name)
        if form.name == "NAME":
            result[name] = plain(value, detail, store, ros)
        elif form.name in ("ARRAY", "SEQUENCE") and detail[0][0].name == "NAME":
            result[name] = [plain(one, detail[0][1], store, ros) for one in value]
        else:
            result[name] = value.tolist() if hasattr(value, "tolist") else value
    return result


def namespaces(value: Any) -> Any:
    """JSON as objects with attributes, as messages are."""
    if isinstance(value, dict):
        return SimpleNamespace(**{str(key): namespaces(one) for key, one in value.items()})
    if isinstance(value, list) and value and isinstance(value[0], (dict, list)):
        return [namespaces(one) for one in value]
    return value
