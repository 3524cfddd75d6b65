"""The frames of a simulation for its viewers, in a list that each viewer reads at its own pace.

There is no queue for a viewer, so a slow one costs no memory and the simulation waits for none of them. A viewer can
hold the simulation and have single steps executed; it goes on when the last viewer has left.
"""

from __future__ import annotations

import struct
import threading
import time
from typing import TYPE_CHECKING, Any

from irsim.runs.replay.growing import GrowingRun

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["ALIVE", "BEGIN", "END", "FAILED", "RESULT", "ROWS", "Feed", "Follower", "frame"]

BEGIN, ROWS, END, ALIVE, RESULT, FAILED = 1, 2, 3, 4, 5, 6
"""Kinds of frames: a new run, further rows, how it ended, one that only says that the server is there, and for the
editor the result of a run as JSON, or why it failed."""
_HEADER = struct.Struct("<IBI")
_PERIOD_S = 0.05
"""Time between two frames of rows [s]."""
_WAKE_S = 0.5
"""Time after which a simulation that is held looks whether it still is [s]."""


def frame(kind: int, number: int, content: bytes = b"") -> bytes:
    """A frame: length of its content (4 bytes, little endian), kind (1), number in the feed (4), and the content."""
    return _HEADER.pack(len(content), kind, number) + content


class Feed:
    """Frames of a run, and what its viewers command.

    Attributes:
        viewers: Number of viewers that are reading.
        left: Moment in which the last viewer left; None as long as none has.
        closed: Whether no frame follows, so that viewers leave once they have all.
    """

    def __init__(self) -> None:
        self._change = threading.Condition()
        self._frames = list[bytes]()
        self._held = False
        self._steps = 0
        self.viewers = 0
        self.left: float | None = None
        self.closed = False

    def put(self, kind: int, content: bytes) -> None:
        """Append a frame."""
        with self._change:
            self._frames.append(frame(kind, len(self._frames), content))
            self._change.notify_all()

    def after(self, number: int, timeout: float) -> list[bytes]:
        """The frames from a number on; waits for the first of them, but not longer than ``timeout`` [s]."""
        with self._change:
            self._change.wait_for(lambda: len(self._frames) > number or self.closed, timeout)
            return self._frames[number:]

    def close(self) -> None:
        """Say that no frame follows."""
        with self._change:
            self.closed, self._held = True, False
            self._change.notify_all()

    def enter(self) -> None:
        """Count a viewer that begins to read."""
        with self._change:
            self.viewers += 1

    def leave(self) -> None:
        """Count a viewer that is gone; the last one leaves no simulation held."""
        with self._change:
            self.viewers -= 1
            if not self.viewers:
                self.left = time.monotonic()
                self._held = False
            self._change.notify_all()

    def hold(self, held: bool) -> None:
        """Hold the simulation after its present step, or let it go on."""
        with self._change:
            self._held, self._steps = held, 0
            self._change.notify_all()

    def advance(self, steps: int) -> None:
        """Have a simulation that is held execute so many steps."""
        with self._change:
            self._steps += steps
            self._change.notify_all()

    def is_held(self) -> bool:
        """Whether the next step has to wait; one of the steps that were commanded is used up."""
        with self._change:
            if self._held and self._steps:
                self._steps -= 1
                return False
            return self._held

    def wait(self) -> None:
        """Wait until the next step may be executed, in intervals in which Ctrl-C is noticed everywhere."""
        while self.is_held():
            with self._change:
                self._change.wait_for(lambda: not self._held or self._steps > 0, _WAKE_S)


class Follower:
    """Reads a simulation after each of its steps and puts what it sees into a feed.

    Args:
        feed: The feed.
        simulation: The simulation of one world, at its start.
        horizon: Greatest number of steps.
        facts: Further entries of the head of the run.
    """

    def __init__(self, feed: Feed, simulation: Simulation, horizon: int, **facts: Any) -> None:
        self._feed = feed
        self._run = GrowingRun(simulation, horizon, **facts)
        self._due = time.monotonic()
        feed.put(BEGIN, self._run.head)

    def __call__(self, done: int, total: int) -> None:
        """Look at the state after a step, and wait if a viewer holds the simulation."""
        over = done >= total
        self._run.look(last=over)
        if over or time.monotonic() >= self._due:
            self.flush()
        if not over and self._feed.is_held():
            self.flush()
            self._feed.wait()

    def flush(self, *, last: bool = False) -> None:
        """Put the rows since the last frame into the feed.

        Args:
            last: Whether the present state is the last one.
        """
        if last:
            self._run.look(last=True)
        block = self._run.block()
        if block is not None:
            self._feed.put(ROWS, block)
        self._due = time.monotonic() + _PERIOD_S
