"""Commands to real robots, handed to a process that outlives this one."""

from __future__ import annotations

import json
import os
import selectors
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict

from irsim.bridges.base import BridgeError, BridgeLostError
from irsim.bridges.ros.guard import READY, Velocity
from irsim.bridges.ros.topics import Topic
from irsim.common.child import Child
from irsim.components.bridges._ros import RosOptions

__all__ = ["Guard"]

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
