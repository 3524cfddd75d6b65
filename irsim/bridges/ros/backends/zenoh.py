"""``zenoh``: a node of ROS 2 whose middleware is rmw_zenoh, without a ROS installation.

Data goes to the key ``<domain>/<topic>/<type>/RIHS01_<hash>``, with an attachment that has number, time and source;
tokens below ``@ros2_lv`` show the node and its endpoints to other nodes. DDS and Zenoh nodes do not see each other.
"""

# ruff: noqa: E402  # the library is asked for first
from __future__ import annotations

import json
import os
import struct
import time
from functools import partial
from typing import Any

from irsim.bridges.base import BridgeError, BridgeLostError
from irsim.bridges.ros.backends.base import Backend, Node
from irsim.bridges.ros.incoming import Inbox
from irsim.bridges.ros.topics import Qos, Topic
from irsim.common.extras import require
from irsim.components.bridges.ros2 import Ros2

require("zenoh", "zenoh", "rosbags")
import zenoh

__all__ = ["ZenohBackend"]

_GID_BYTES = 16


class ZenohBackend(Backend):
    """A session of Zenoh that shows itself as a node of ROS 2.

    Args:
        node: The node.
        options: Address of the router, and whether to be the router there, so that no ``rmw_zenohd`` is needed.
        domain: Number of the domain (``ROS_DOMAIN_ID``).
    """

    def __init__(self, node: Node, options: Ros2, *, domain: int) -> None:
        super().__init__(node)
        self.peer = f"ROS 2 over Zenoh, domain {domain}, router {options.address}"
        self._domain, self._numbers = domain, dict.fromkeys(self.topics, 0)
        self._publishers: dict[Topic, Any] = {}
        self._kept: list[Any] = []
        self._gids = {topic: os.urandom(_GID_BYTES) for topic in self.topics}
        self._session = _open(options.address, options.router, options.timeout)
        try:
            self._declare()
        except BaseException:
            self.close()
            raise

    def publish(self, topic: Topic, message: Any) -> None:
        """Put a message, with its number, its time and its source."""
        self._numbers[topic] += 1
        head = struct.pack("<qqB", self._numbers[topic], time.time_ns(), _GID_BYTES)
        self._publishers[topic].put(self.messages.cdr(message, topic.kind), attachment=head + self._gids[topic])

    def poll(self) -> None:
        """Messages come in threads of Zenoh."""
        if self._session.is_closed():
            raise BridgeLostError("the session of Zenoh is closed")

    def close(self) -> None:
        """Close the session, with which all tokens go."""
        session, self._session = self._session, None
        if session is not None:
            session.close()
        self._publishers, self._kept = {}, []

    def _declare(self) -> None:
        zid = str(self._session.info.zid())
        alive = self._session.liveliness()
        head = f"@ros2_lv/{self._domain}/{zid}/0"
        self._kept.append(alive.declare_token(f"{head}/0/NN/%/%/{self.node}"))
        for number, topic in enumerate(self.topics, 1):
            package, space, name = topic.kind.split("/")
            type_hash = self.messages.store.hash_rihs01(topic.kind)
            kind = f"{package}::{space}::dds_::{name}_/{type_hash}"
            key = f"{self._domain}/{topic.name.lstrip('/')}/{kind}"
            if topic.outgoing:
                self._publishers[topic] = self._publisher(key, topic.qos)
            else:
                self._kept.append(self._subscriber(key, topic))
            token = f"{'MP' if topic.outgoing else 'MS'}/%/%/{self.node}/{topic.name.replace('/', '%')}"
            self._kept.append(alive.declare_token(f"{head}/{number}/{token}/{kind}/{_encoded(topic.qos)}"))

    def _publisher(self, key: str, qos: Qos) -> Any:
        drop = zenoh.CongestionControl.BLOCK if qos.reliable else zenoh.CongestionControl.DROP
        if not qos.latched:
            return self._session.declare_publisher(key, congestion_control=drop)
        return zenoh.ext.declare_advanced_publisher(
            self._session, key, congestion_control=drop, cache=zenoh.ext.CacheConfig(max_samples=qos.depth),
            publisher_detection=True,
        )  # fmt: skip

    def _subscriber(self, key: str, topic: Topic) -> Any:
        put = partial(_received, self.inbox, topic)
        if not topic.qos.latched:
            return self._session.declare_subscriber(key, put)
        history = zenoh.ext.HistoryConfig(detect_late_publishers=True, max_samples=topic.qos.depth)
        return zenoh.ext.declare_advanced_subscriber(self._session, key, put, history=history)


def _received(inbox: Inbox, topic: Topic, sample: Any) -> None:
    inbox.put(topic, sample.payload.to_bytes())


def _open(address: str, router: bool, timeout: float) -> Any:
    """A session of a router or of a client of one."""
    endpoint = json.dumps([f"tcp/{address}"])
    config = zenoh.Config()
    settings = {"scouting/multicast/enabled": "false", "timestamping/enabled": "true"}
    settings["mode"] = '"router"' if router else '"client"'
    if router:
        settings["listen/endpoints"] = endpoint
    else:
        milliseconds = str(round(timeout * 1000))
        settings |= {
            "connect/endpoints": endpoint,
            "connect/timeout_ms": milliseconds,
            "connect/exit_on_failure": "true",
        }
    for key, value in settings.items():
        config.insert_json5(key, value)
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        why = str(error).split(" at /")[0]  # then comes a place in the sources of Zenoh
        if router:
            what, fix = f"a Zenoh router cannot listen at {address}: {why}", "name another port in `address`"
            raise BridgeError("bridge-failed", what, fix) from None
        fix = "start the router: ros2 run rmw_zenoh_cpp rmw_zenohd, or write router: true"
        raise BridgeLostError(f"no Zenoh router answers at {address}: {why}", fix) from None


def _encoded(qos: Qos) -> str:
    """Quality of service as rmw_zenoh writes it; what is left out is the default."""
    reliability, durability = "" if qos.reliable else "2", "1" if qos.latched else ""
    return f"{reliability}:{durability}:,{qos.depth}:,:,:,,"
