"""The backend of rclpy with a stand-in of rclpy: a graph of topics in this process that carries bytes."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import ModuleType
from types import SimpleNamespace as N
from typing import Any

import pytest

from irsim.bridges.base import BridgeError
from irsim.bridges.ros.backends.base import Node
from irsim.bridges.ros.backends.opening import open_backend
from irsim.bridges.ros.incoming import Inbox
from irsim.bridges.ros.topics import LATCHED, STATE, Topic
from irsim.components.bridges.ros2 import Ros2

ODOM = Topic("odom", "/r/odom", "nav_msgs/msg/Odometry", True, LATCHED, "r")
COMMAND = Topic("cmd_vel", "/r/cmd_vel", "geometry_msgs/msg/Twist", False, STATE, "r")


class Graph:
    """The requests to the stand-in."""

    def __init__(self) -> None:
        self.published: list[tuple[str, Any]] = []
        self.callbacks: dict[str, Callable[[bytes], None]] = {}
        self.qos: dict[str, Any] = {}
        self.waiting: list[tuple[str, bytes]] = []
        self.domain: int | None = None
        self.open = 0

    def create_publisher(self, kind: Any, name: str, qos: Any) -> Any:
        self.qos[name] = qos
        return N(publish=lambda content: self.published.append((name, content)))

    def create_subscription(self, kind: Any, name: str, callback: Any, qos: Any, *, raw: bool) -> Any:
        assert raw
        self.callbacks[name] = callback
        return N()

    def spin_once(self, timeout_sec: float) -> None:
        assert timeout_sec == 0
        if self.waiting:
            name, content = self.waiting.pop(0)
            self.callbacks[name](content)

    def destroy_node(self) -> None:
        self.open -= 1


@pytest.fixture
def graph(monkeypatch: pytest.MonkeyPatch) -> Graph:
    stand_in = Graph()

    def init(args: Any, context: Any, domain_id: int | None) -> None:
        stand_in.domain, context.live = domain_id, True

    def create_node(name: str, context: Any) -> Graph:
        stand_in.open += 1
        return stand_in

    class Context:
        live = False

        def ok(self) -> bool:
            return self.live

    def put(name: str, **content: Any) -> None:
        module = ModuleType(name)
        module.__dict__.update(content)
        module.__spec__ = N(name=name)  # type: ignore[assignment]
        monkeypatch.setitem(sys.modules, name, module)

    put("rclpy", init=init, create_node=create_node, shutdown=lambda context: setattr(context, "live", False))
    put("rclpy.context", Context=Context)
    put("rclpy.executors", SingleThreadedExecutor=lambda context: N(add_node=lambda node: None,
                                                                   spin_once=stand_in.spin_once))  # fmt: skip
    levels = N(RELIABLE=1, BEST_EFFORT=2, TRANSIENT_LOCAL=1, VOLATILE=2, KEEP_LAST=1)
    put("rclpy.qos", QoSProfile=N, HistoryPolicy=levels, ReliabilityPolicy=levels, DurabilityPolicy=levels)
    put("nav_msgs")
    put("nav_msgs.msg", Odometry=object)
    put("geometry_msgs")
    put("geometry_msgs.msg", Twist=object)
    return stand_in


MESSAGES: Any = N(cdr=lambda message, kind: f"{kind}:{message}".encode())


def test_serialized_messages_cross_both_ways(graph: Graph) -> None:
    inbox = Inbox()
    backend = open_backend(Ros2(domain=7), Node("lab", [ODOM, COMMAND], inbox, MESSAGES))  # auto finds rclpy
    assert type(backend).__name__ == "RclpyBackend"
    assert graph.domain == 7
    assert (graph.qos["/r/odom"].durability, graph.qos["/r/odom"].depth) == (1, 1)
    backend.publish(ODOM, "here")
    assert graph.published == [("/r/odom", b"nav_msgs/msg/Odometry:here")]
    graph.waiting = [("/r/cmd_vel", b"%d" % number) for number in range(150)]
    backend.poll()
    assert graph.waiting == []
    assert [arrival.content for arrival in inbox.take().values()] == [b"149"]
    backend.close()
    backend.close()
    assert graph.open == 0


def test_a_flood_does_not_hold_up_a_step(graph: Graph) -> None:
    backend = open_backend(Ros2(), Node("lab", [ODOM, COMMAND], Inbox(), MESSAGES))
    graph.waiting = [("/r/cmd_vel", b"")] * 5000
    backend.poll()
    assert len(graph.waiting) == 4800
    backend.close()


def test_a_missing_package_is_named_with_its_debian_package(graph: Graph, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "nav_msgs.msg", ModuleType("nav_msgs.msg"))
    with pytest.raises(BridgeError, match=r"no messages nav_msgs/msg/Odometry.*ros-\$ROS_DISTRO-nav-msgs"):
        open_backend(Ros2(), Node("lab", [ODOM], Inbox(), MESSAGES))
    assert graph.open == 0


def test_without_rclpy_the_error_says_what_to_source() -> None:
    with pytest.raises(BridgeError, match=r"setup.bash, or write backend: dds"):
        open_backend(Ros2(backend="rclpy"), Node("lab", [], Inbox(), MESSAGES))
