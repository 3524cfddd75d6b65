"""``bag``: a recording instead of a robot, a folder of rosbag2 with SQLite or MCAP storage."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

from irsim.bridges.base import BridgeError
from irsim.bridges.ros.backends.base import Backend, Node
from irsim.bridges.ros.messages import Messages
from irsim.bridges.ros.topics import LATCHED, STATE, Qos, Topic
from irsim.common.extras import require
from irsim.common.files import new_folder

__all__ = ["BagBackend", "BagFolder", "Storage"]

Storage = Literal["sqlite3", "mcap"]
_VERSION = 8
"""Version of rosbag2's metadata: Iron and later write it, and Humble reads it; 9, of Jazzy, Humble cannot parse."""


class BagFolder:
    """A folder of rosbag2 that is written message by message.

    Args:
        target: The folder, which is made if it does not exist.
        messages: Makes messages, and their CDR.
        storage: How messages are stored.
        name: Name that the folder will have, after which the file in it is named.
    """

    def __init__(self, target: Path, messages: Messages, storage: Storage, name: str) -> None:
        require("bag", "rosbags")
        from rosbags.rosbag2 import StoragePlugin, Writer

        plugin = StoragePlugin.SQLITE3 if storage == "sqlite3" else StoragePlugin.MCAP
        self._target, self._inner = target, target / name  # rosbags names the file after its folder
        self._writer = Writer(self._inner, version=_VERSION, storage_plugin=plugin)
        self._writer.open()
        self._messages = messages

    def __enter__(self) -> BagFolder:
        return self

    def __exit__(self, kind: type[BaseException] | None, *rest: object) -> None:
        if kind is not None:
            self._writer.abort()
            return
        self._writer.close()
        for file in self._inner.iterdir():
            file.rename(self._target / file.name)
        self._inner.rmdir()

    def topic(self, name: str, kind: str, *, latched: bool = False, **about: str) -> tuple[Any, str]:
        """Add a topic.

        Args:
            name: Its name.
            kind: Type of its messages.
            latched: Whether new subscribers get its last message.
            **about: Further facts, which go into the custom data of the bag.

        Returns:
            The handle that :meth:`add` takes.
        """
        for key, value in about.items():
            self._writer.set_custom_data(f"{name} {key}", value)
        return self.topic_of(name, kind, LATCHED if latched else STATE)

    def topic_of(self, name: str, kind: str, qos: Qos) -> tuple[Any, str]:
        """Add a topic with a quality of service."""
        added = self._writer.add_connection(
            name, kind, typestore=self._messages.store, offered_qos_profiles=[_stored(qos)]
        )
        return added, kind

    def add(self, topic: tuple[Any, str], stamp: int, message: Any) -> None:
        """Add a message at a time [ns]."""
        connection, kind = topic
        self._writer.write(connection, stamp, self._messages.cdr(message, kind))

    def describe(self, facts: dict[str, str], files: dict[str, bytes]) -> None:
        """Add facts, and files as text, to the custom data."""
        for key, value in facts.items():
            self._writer.set_custom_data(f"irsim {key}", value)
        for name, content in files.items():
            self._writer.set_custom_data(name, content.decode())


class BagBackend(Backend):
    """Records what would be published; the folder gets its name when it is complete.

    Args:
        node: The node, whose incoming topics are left out.
        folder: The folder, which must not exist.
        storage: How messages are stored.
    """

    def __init__(self, node: Node, *, folder: Path, storage: Storage) -> None:
        super().__init__(replace(node, topics=[topic for topic in node.topics if topic.outgoing]))
        if folder.exists():
            raise BridgeError("file-exists", f"'{folder}' exists", "name another folder, or remove it")
        self.peer = f"the bag {folder}"
        self._place = ExitStack()
        temporary = self._place.enter_context(new_folder(folder))
        self._bag: BagFolder | None = BagFolder(temporary, node.messages, storage, folder.name)
        self._added = {topic: self._bag.topic_of(topic.name, topic.kind, topic.qos) for topic in self.topics}
        self.stamp = 0
        """Time of the messages that are published next [ns]."""

    def publish(self, topic: Topic, message: Any) -> None:
        """Record a message."""
        if self._bag is not None:
            self._bag.add(self._added[topic], self.stamp, message)

    def drop(self) -> None:
        """Leave nothing behind."""
        bag, self._bag = self._bag, None
        if bag is not None:
            try:
                bag.__exit__(KeyboardInterrupt)
            finally:
                self._place.__exit__(KeyboardInterrupt, KeyboardInterrupt(), None)

    def close(self) -> None:
        """Complete the folder."""
        bag, self._bag = self._bag, None
        if bag is not None:
            with self._place:
                bag.__exit__(None, None, None)


def _stored(qos: Qos) -> Any:
    from rosbags import interfaces

    never = interfaces.QosTime(9223372036, 854775807)
    return interfaces.Qos(
        interfaces.QosHistory.KEEP_LAST,
        qos.depth,
        interfaces.QosReliability.RELIABLE if qos.reliable else interfaces.QosReliability.BEST_EFFORT,
        interfaces.QosDurability.TRANSIENT_LOCAL if qos.latched else interfaces.QosDurability.VOLATILE,
        never,
        never,
        interfaces.QosLiveliness.AUTOMATIC,
        never,
        False,
    )
