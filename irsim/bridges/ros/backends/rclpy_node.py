"""``rclpy``: a node of the ROS 2 installation whose environment is sourced, with its middleware and parameters.

Messages cross in serialized form, so that the classes of ROS are needed for their types only.
"""

from __future__ import annotations

from functools import partial
from importlib import import_module
from typing import Any

from irsim.bridges.ros.backends.base import Backend, Node, message_class
from irsim.bridges.ros.topics import Qos, Topic

__all__ = ["RclpyBackend"]

_MAX_CALLBACKS = 200
"""Callbacks that are handled in one step at most, so that a flood cannot hold it up."""


class RclpyBackend(Backend):
    """A node of rclpy.

    Args:
        node: The node.
        domain: Number of the domain; None takes ``ROS_DOMAIN_ID``.
    """

    def __init__(self, node: Node, *, domain: int | None) -> None:
        super().__init__(node)
        self._rclpy = import_module("rclpy")
        self._context = import_module("rclpy.context").Context()
        self._rclpy.init(args=None, context=self._context, domain_id=domain)
        self.peer = "ROS 2 with rclpy"
        self._node: Any = None
        try:
            self._node = self._rclpy.create_node(node.name, context=self._context)
            self._executor = import_module("rclpy.executors").SingleThreadedExecutor(context=self._context)
            self._executor.add_node(self._node)
            self._publishers: dict[Topic, Any] = {}
            self._subscriptions = [self._add(topic) for topic in self.topics]
        except BaseException:
            self.close()
            raise

    def publish(self, topic: Topic, message: Any) -> None:
        """Publish a message that is serialized already."""
        self._publishers[topic].publish(self.messages.cdr(message, topic.kind))

    def poll(self) -> None:
        """Handle what has come."""
        for _ in range(_MAX_CALLBACKS):
            received = self.inbox.received
            self._executor.spin_once(timeout_sec=0.0)
            if self.inbox.received == received:
                break

    def close(self) -> None:
        """Destroy the node."""
        node, self._node = self._node, None
        if node is not None:
            node.destroy_node()
        if self._context.ok():
            self._rclpy.shutdown(context=self._context)

    def _add(self, topic: Topic) -> Any:
        kind, qos = message_class(topic.kind, "ros-$ROS_DISTRO-{}"), _profile(topic.qos)
        if topic.outgoing:
            self._publishers[topic] = self._node.create_publisher(kind, topic.name, qos)
            return None
        put = partial(self.inbox.put, topic)
        return self._node.create_subscription(kind, topic.name, put, qos, raw=True)


def _profile(qos: Qos) -> Any:
    names = import_module("rclpy.qos")
    return names.QoSProfile(
        depth=qos.depth,
        history=names.HistoryPolicy.KEEP_LAST,
        reliability=names.ReliabilityPolicy.RELIABLE if qos.reliable else names.ReliabilityPolicy.BEST_EFFORT,
        durability=names.DurabilityPolicy.TRANSIENT_LOCAL if qos.latched else names.DurabilityPolicy.VOLATILE,
    )
