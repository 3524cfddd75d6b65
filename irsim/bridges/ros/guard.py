"""The process between irsim and real robots: it sends zero commands when irsim hangs, fails, or is killed.

``python -m irsim.bridges.ros.guard`` is started by :class:`irsim.bridges.ros.guarded.Guard`. It has a node of its own,
which alone publishes commands, at a fixed rate and within the limits. It reads lines of JSON from its standard input:
first what to publish and how, then commands. Commands that are too old count as zero, and when the input ends, because
irsim has ended in whatever way, it sends zeros for a while and ends, too.
"""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from typing import Any, TextIO

from irsim.bridges.base import BridgeError
from irsim.bridges.ros.backends.base import Backend
from irsim.bridges.ros.backends.opening import make_messages, open_backend
from irsim.bridges.ros.inbox import Inbox
from irsim.bridges.ros.limiting import ZERO, Limits, Velocity, limited
from irsim.bridges.ros.messages import Messages
from irsim.bridges.ros.qos import Qos
from irsim.bridges.ros.topics import Topic
from irsim.components.bridges._ros import RosOptions
from irsim.diagnostics.errors import CodedError
from irsim.options.registry import BRIDGES

__all__ = ["READY", "limits_of", "main"]

READY = "ready"
"""The line with which the process says that it publishes."""
_ZEROS, _ZERO_PERIOD_S = 20, 0.05
"""How many zero commands are sent at the end, and the time between two of them."""


def limits_of(options: RosOptions) -> Limits:
    """The limits in options."""
    return Limits(
        options.max_speed, options.max_turn, options.max_acceleration, options.max_turn_acceleration
    )  # fmt: skip


class _Input:
    """The newest commands, read by a thread.

    Attributes:
        ended: Set when there is nothing more to come.
    """

    def __init__(self, stream: TextIO) -> None:
        self.ended = threading.Event()
        self._newest: tuple[float, Mapping[str, Any]] = (float("-inf"), {})
        self._stream = stream
        threading.Thread(target=self._read, daemon=True).start()

    def commands(self, oldest: float) -> Mapping[str, Any]:
        """The newest commands, none if they came before a time."""
        when, commands = self._newest
        return commands if when >= oldest else {}

    def _read(self) -> None:
        try:
            for line in self._stream:
                self._newest = (time.monotonic(), json.loads(line))
        finally:
            self.ended.set()


def main(stream: TextIO = sys.stdin) -> int:
    """Publish commands until the input ends."""
    for number in (signal.SIGTERM, signal.SIGHUP) if hasattr(signal, "SIGHUP") else (signal.SIGTERM,):
        signal.signal(number, _interrupted)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    first = json.loads(stream.readline())
    feature = BRIDGES.get(first["options"]["name"])
    assert feature is not None
    options: Any = feature.options.model_validate(first["options"])
    topics = [Topic(**{**item, "qos": Qos(**item["qos"])}) for item in first["topics"]]
    try:
        messages = make_messages(options)
        backend = open_backend(options, f"{options.node}_guard", topics, Inbox(), messages)
    except CodedError as error:
        print(json.dumps({"code": error.code, "message": error.message, "fix": error.fix}), flush=True)
        return 1
    source = _Input(stream)
    print(READY, flush=True)
    try:
        _publish(backend, messages, topics, options, source)
    except (BridgeError, KeyboardInterrupt):
        pass
    finally:
        for _ in range(_ZEROS):
            with suppress(BridgeError):
                _send(backend, messages, topics, {})
            time.sleep(_ZERO_PERIOD_S)
        backend.close()
    return 0


def _publish(backend: Backend, messages: Messages, topics: list[Topic], options: RosOptions, source: _Input) -> None:
    """Send commands at a fixed rate until there is nothing more to come."""
    limits, period, parent = limits_of(options), 1.0 / options.command_rate, os.getppid()
    sent = {str(topic.robot): ZERO for topic in topics}
    before = time.monotonic()
    while not source.ended.wait(period) and os.getppid() == parent:
        now = time.monotonic()
        wanted = source.commands(now - options.command_timeout) if backend.ready else {}
        elapsed = min(now - before, 2 * period)
        sent = {name: limited(wanted.get(name, ZERO), last, limits, elapsed) for name, last in sent.items()}
        before = now
        _send(backend, messages, topics, sent)


def _send(backend: Backend, messages: Messages, topics: list[Topic], commands: Mapping[str, Velocity]) -> None:
    for topic in topics:
        command = commands.get(str(topic.robot), ZERO)
        backend.publish(topic, messages.command(topic.kind, time.time_ns(), "base_link", command))


def _interrupted(number: int, frame: Any) -> None:
    raise KeyboardInterrupt


if __name__ == "__main__":
    sys.exit(main())
