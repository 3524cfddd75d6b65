"""Commands to real robots: a process that sends zero commands when irsim hangs, fails, or is killed, and its handle.

``python -m irsim.bridges.ros.guard`` is started by :class:`Guard`. It has a node of its own, which alone publishes
commands, at a fixed rate and within the limits. It reads lines of JSON from its standard input: first what to publish
and how, then commands. Commands that are too old count as zero, and when the input ends, because irsim has ended in
whatever way, it sends zeros for a while and ends, too.
"""

from __future__ import annotations

import json
import math
import os
import selectors
import signal
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from typing import Any, TextIO

from irsim.bridges.base import BridgeError, BridgeLostError
from irsim.bridges.ros.backends.base import Backend, Node
from irsim.bridges.ros.backends.opening import make_messages, open_backend
from irsim.bridges.ros.incoming import Inbox
from irsim.bridges.ros.messages import Messages
from irsim.bridges.ros.topics import Qos, Topic
from irsim.common.child import Child
from irsim.components.bridges._ros import RosOptions
from irsim.diagnostics.errors import CodedError
from irsim.options.registry import BRIDGES

__all__ = ["LIFE", "READY", "ZERO", "Guard", "Limits", "Velocity", "limited", "limits_of", "main"]

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
        backend = open_backend(options, Node(f"{options.node}_guard", topics, Inbox(), messages))
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


_START_S = 30.0
"""Time for which the start of the process may take; ROS takes some seconds to import on small computers."""
_STOP_S = 5.0
_SILENT_S = 1.0
"""Time for which the process may be silent in addition to the timeout of commands."""
_READ_BYTES = 65536


class Guard:
    """The process that publishes commands, see :mod:`irsim.bridges.ros.guard`.

    Args:
        options: Options of the bridge.
        topics: Topics of commands, one for each robot.

    Raises:
        BridgeError: The process cannot connect.
    """

    def __init__(self, options: RosOptions, topics: Sequence[Topic]) -> None:
        self._child = Child([sys.executable, "-m", "irsim.bridges.ros.guard"])  # Ctrl-C reaches irsim only
        self._process, self._input, self._output = self._child.process, self._child.input, self._child.output
        try:
            first = {"options": options.model_dump(mode="json"), "topics": [asdict(topic) for topic in topics]}
            self._write(first)
            self._wait_until_ready()
            os.set_blocking(self._input.fileno(), False)
            os.set_blocking(self._output.fileno(), False)
            self._alive, self._silence = time.monotonic(), options.command_timeout + _SILENT_S
        except BaseException:
            self.stop()
            raise

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._process.pid

    def send(self, commands: Mapping[str, Velocity]) -> None:
        """Hand over commands; robots that are left out get zero.

        Raises:
            BridgeLostError: The process has ended or hangs.
        """
        if self._process.poll() is not None:
            raise BridgeLostError("the process that sends commands to the robots has ended")
        with suppress(BlockingIOError):
            if os.read(self._output.fileno(), _READ_BYTES):
                self._alive = time.monotonic()
        if time.monotonic() - self._alive > self._silence:
            self._process.kill()
            raise BridgeLostError("the process that sends commands to the robots hangs")
        try:
            self._write(commands)
        except OSError:
            raise BridgeLostError("the process that sends commands to the robots does not read them") from None

    def stop(self) -> None:
        """Let the process send zero commands and end."""
        self._child.end(_STOP_S)

    def _write(self, content: object) -> None:
        line = json.dumps(content).encode() + b"\n"
        if self._input.write(line) != len(line):
            raise OSError("the pipe is full")

    def _wait_until_ready(self) -> None:
        line, until = b"", time.monotonic() + _START_S
        with selectors.DefaultSelector() as waiting:
            waiting.register(self._output, selectors.EVENT_READ)
            while not line.endswith(b"\n"):
                left = until - time.monotonic()
                if left <= 0 or not waiting.select(left):
                    raise BridgeLostError(f"the process that sends commands did not start within {_START_S:g} s")
                part = os.read(self._output.fileno(), 4096)
                if not part:
                    raise BridgeLostError("the process that sends commands ended at its start")
                line += part
        # libraries may print something before
        last = line.decode(errors="replace").strip().splitlines()[-1]
        if last != READY:
            try:
                error = json.loads(last)
                raise BridgeError(error["code"], error["message"], error["fix"])
            except (ValueError, KeyError, TypeError):
                raise BridgeLostError(f"the process that sends commands said {last[:200]!r}") from None


if __name__ == "__main__":
    sys.exit(main())
