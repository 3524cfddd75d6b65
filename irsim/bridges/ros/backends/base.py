"""The interface of backends."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from irsim.bridges.ros.incoming import Inbox
from irsim.bridges.ros.messages import Messages
from irsim.bridges.ros.topics import Topic

__all__ = ["Backend"]


class Backend:
    """A node that publishes and subscribes to topics.

    Args:
        node: Name of the node.
        topics: Topics to publish and to subscribe to.
        inbox: Where messages from outside are put.
        messages: Makes messages, and their CDR.

    Attributes:
        peer: The program that it is connected to, in a few words.
    """

    peer = "ROS"

    def __init__(self, node: str, topics: Sequence[Topic], inbox: Inbox, messages: Messages) -> None:
        self.node, self.topics, self.inbox, self.messages = node, tuple(topics), inbox, messages

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
