"""Messages from outside, of which only the newest of each topic is kept: a flood costs no memory and no time."""

from __future__ import annotations

import time
from dataclasses import dataclass
from threading import Lock
from typing import Any

from irsim.bridges.ros.topics import Topic

__all__ = ["MAX_BYTES", "Arrival", "Inbox"]

MAX_TOLD = 100
"""Number of sentences of another program that are kept until they are read."""
MAX_BYTES = 8_000_000
"""Longest message that is kept; a scan of 100,000 beams has less than 1 MB."""


@dataclass(frozen=True)
class Arrival:
    """What came last on a topic.

    Attributes:
        content: CDR, or a message whose fields are attributes.
        when: Time of arrival [s], of the clock ``time.monotonic``.
    """

    content: Any
    when: float


class Inbox:
    """Keeps the newest message of each topic; any thread may put messages in."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._newest: dict[Topic, Arrival] = {}
        self._told: list[str] = []
        self.received = 0
        self.overwritten = 0
        self.refused = 0

    def put(self, topic: Topic, content: Any) -> None:
        """Keep a message instead of an older one of the same topic."""
        arrival = Arrival(content, time.monotonic())
        with self._lock:
            self.received += 1
            if isinstance(content, bytes) and len(content) > MAX_BYTES:
                self.refused += 1
                return
            self.overwritten += topic in self._newest
            self._newest[topic] = arrival

    def take(self) -> dict[Topic, Arrival]:
        """All that has come since the last call."""
        with self._lock:
            found, self._newest = self._newest, {}
        return found

    def tell(self, sentence: str) -> None:
        """Keep what the other program says about itself."""
        with self._lock:
            if len(self._told) < MAX_TOLD:
                self._told.append(sentence)

    def told(self) -> list[str]:
        """What the other program has said since the last call."""
        with self._lock:
            found, self._told = self._told, []
        return found
