"""The interface of backends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from irsim.bridges.base import BridgeError
from irsim.bridges.ros.incoming import Inbox
from irsim.bridges.ros.messages import Messages
from irsim.bridges.ros.topics import Topic

__all__ = ["Backend", "Node", "message_class"]


@dataclass(frozen=True)
class Node:
    """A node that a backend shows to other programs.

    Attributes:
        name: Its name.
        topics: Topics to publish and to subscribe to.
        inbox: Where messages from outside are put.
        messages: Makes messages, and their CDR.
    """

    name: str
    topics: Sequence[Topic]
    inbox: Inbox
    messages: Messages


class Backend:
    """A node that publishes and subscribes to topics.

    Attributes:
        peer: The program that it is connected to, in a few words.
    """

    peer = "ROS"

    def __init__(self, node: Node) -> None:
        self.node, self.topics, self.inbox, self.messages = node.name, tuple(node.topics), node.inbox, node.messages

    @property
    def ready(self) -> bool:
        """Whether what is published now goes out; not while a connection is made anew."""
        return True

    def publish(self, topic: Topic, message: Any) -> None:
        """Send a message.

        Raises:
            BridgeLostError: The connection is gone.
        """
        raise NotImplementedError

    def poll(self) -> None:
        """Put into the inbox what has come, if no thread of the library does so.

        Raises:
            BridgeLostError: The connection is gone.
        """

    def close(self) -> None:
        """Disconnect; a second call does nothing."""


def message_class(kind: str, package: str) -> Any:
    """The class of a message in the ROS installation, such as ``nav_msgs/msg/Path``.

    Raises:
        BridgeError: The installation lacks it; the message names the package of Debian, ``package``, that has it.
    """
    space, _, name = kind.rpartition("/")
    try:
        return getattr(import_module(space.replace("/", ".")), name)
    except (ImportError, AttributeError):
        named = package.format(space.partition("/")[0].replace("_", "-"))
        what = f"the ROS installation has no messages {kind}"
        raise BridgeError("bridge-failed", what, f"apt install {named}") from None
