"""Messages from outside, of which only the newest of each topic is kept: a flood costs no memory and no time."""

from __future__ import annotations

import time
from dataclasses import dataclass
from threading import Lock
from typing import Any

from irsim.bridges.ros.topics import Topic

__all__ = ["MAX_BYTES", "Arrival", "Inbox"]

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
