"""The process between irsim and real robots: it sends zero commands when irsim hangs, fails, or is killed.

``python -m irsim.bridges.ros.guard`` is started by :class:`irsim.bridges.ros.guarded.Guard`. It has a node of its own,
which alone publishes commands, at a fixed rate and within the limits. It reads lines of JSON from its standard input:
first what to publish and how, then commands. Commands that are too old count as zero, and when the input ends, because
irsim has ended in whatever way, it sends zeros for a while and ends, too.
"""

from __future__ import annotations

import json
import math
import os
import signal
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, TextIO

from irsim.bridges.base import BridgeError
from irsim.bridges.ros.backends.base import Backend
from irsim.bridges.ros.backends.opening import make_messages, open_backend
from irsim.bridges.ros.incoming import Inbox
from irsim.bridges.ros.messages import Messages
from irsim.bridges.ros.topics import Qos, Topic
from irsim.components.bridges._ros import RosOptions
from irsim.diagnostics.errors import CodedError
from irsim.options.registry import BRIDGES

__all__ = ["LIFE", "READY", "ZERO", "Limits", "Velocity", "limited", "limits_of", "main"]

Velocity = tuple[float, float, float]
"""Forward and leftward speed [m/s], yaw rate [rad/s], body frame."""
ZERO: Velocity = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Limits:
    """Limits of the commands to a real robot.

    Attributes:
        speed: Greatest speed [m/s].
        turn: Greatest yaw rate [rad/s].
        acceleration: Greatest change of the speed [m/s^2].
        turn_acceleration: Greatest change of the yaw rate [rad/s^2].
    """

    speed: float
    turn: float
    acceleration: float
    turn_acceleration: float


def limited(target: Sequence[float], before: Velocity, limits: Limits, period: float) -> Velocity:
    """The command that comes nearest to a wanted one.

    A velocity that is too fast is made slower as a whole, so that its arc stays the same. A stop is immediate, and what
    is not finite is a stop.

    Args:
        target: Wanted velocity.
        before: Command before.
        limits: The limits.
        period: Time since the command before [s].
    """
    if len(target) != 3 or not all(math.isfinite(value) for value in target) or not any(target):
        return ZERO
    speed, turn = math.hypot(target[0], target[1]), abs(target[2])
    scale = min(1.0, limits.speed / speed if speed else 1.0, limits.turn / turn if turn else 1.0)
    forward, left, rate = (scale * value for value in target)
    step = math.hypot(forward - before[0], left - before[1])
    share = min(1.0, limits.acceleration * period / step) if step else 1.0
    change = max(-limits.turn_acceleration * period, min(limits.turn_acceleration * period, rate - before[2]))
    return (
        before[0] + share * (forward - before[0]),
        before[1] + share * (left - before[1]),
        before[2] + change,
    )


READY = "ready"
"""The line with which the process says that it publishes."""
LIFE = b"."
"""The byte that it writes each time when it has published."""
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
    with suppress(OSError, ValueError):
        os.set_blocking(sys.stdout.fileno(), False)
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
        _show_life()


def _send(backend: Backend, messages: Messages, topics: list[Topic], commands: Mapping[str, Velocity]) -> None:
    for topic in topics:
        command = commands.get(str(topic.robot), ZERO)
        backend.publish(topic, messages.command(topic.kind, time.time_ns(), "base_link", command))


def _show_life() -> None:
    """Tell irsim that commands go out; it need not listen."""
    with suppress(OSError, ValueError):
        os.write(sys.stdout.fileno(), LIFE)


def _interrupted(number: int, frame: Any) -> None:
    raise KeyboardInterrupt


if __name__ == "__main__":
    sys.exit(main())
