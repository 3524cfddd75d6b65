"""Lines to and from another process, over its standard streams or a local socket, each within a time limit."""

from __future__ import annotations

import contextlib
import io
import os
import queue
import socket
import threading
from collections.abc import Callable, Sequence
from typing import BinaryIO, cast

from irsim.common.child import Child, Writer, write_to_pipe

__all__ = ["Channel", "PeerError", "connect", "start"]

MAX_LINE_BYTES = 64_000_000
"""Longest line that is read."""
_GRACE_S = 1.0
"""Time that a process has to end by itself [s]."""
_LOCAL = ("localhost", "127.0.0.1", "::1")
"""Hosts of this machine."""


class PeerError(Exception):
    """The other process did not answer as it should.

    Args:
        message: The end of the sentence ``the policy …``.
        fix: Advice to the user.
    """

    def __init__(self, message: str, fix: str = "look at what its process prints") -> None:
        super().__init__(message)
        self.fix = fix


class Channel:
    """A connection to another process.

    Lines are written and read by a thread of their own, so that a process which neither reads nor writes cannot block
    longer than the time limit.

    Args:
        reader, writer: Streams from and to the process.
        close: Ends the connection.
        ended: The reason why no more lines come, in words.
    """

    def __init__(
        self,
        reader: BinaryIO,
        writer: Writer,
        close: Callable[[], None],
        ended: Callable[[], str] = lambda: "has closed the connection",
    ) -> None:
        self._asked: queue.SimpleQueue[bytes | None] = queue.SimpleQueue()
        self._answers: queue.SimpleQueue[bytes | Exception] = queue.SimpleQueue()
        self._close, self._ended, self._closed = close, ended, False
        talk = threading.Thread(target=_talk, args=(reader, writer, self._asked, self._answers), daemon=True)
        talk.start()

    def ask(self, line: bytes, seconds: float) -> bytes:
        """Send a line and return the one that answers it.

        Args:
            line: One line without its end.
            seconds: Longest time to wait [s].

        Raises:
            TimeoutError: No answer came in time.
            PeerError: The process has ended, or its line is too long.
        """
        self._asked.put(line)
        try:
            answer = self._answers.get(timeout=seconds)
        except queue.Empty:
            raise TimeoutError from None
        if isinstance(answer, OSError) or answer == b"":
            raise PeerError(self._ended())
        if isinstance(answer, Exception):
            raise PeerError(str(answer))
        return answer

    def close(self) -> None:
        """End the connection, and the process if it was started for it."""
        if not self._closed:
            self._closed = True
            self._asked.put(None)
            self._close()


def start(command: Sequence[str], folder: str | None = None) -> Channel:
    """Start a program and talk to its standard input and output; its standard error is this process's.

    Raises:
        PeerError: The program cannot be started.
    """
    try:
        child = Child(command, cwd=folder, env={**os.environ, "PYTHONUNBUFFERED": "1"})
    except (OSError, ValueError) as error:
        raise PeerError(f"cannot be started: {error}", "correct its command") from error
    reader = io.BufferedReader(cast(io.FileIO, child.output))  # without a buffer it is one
    return Channel(reader, child.input, lambda: child.end(_GRACE_S), lambda: _ended(child))


def connect(address: str, seconds: float) -> Channel:
    """Connect to a process that listens on this machine.

    Args:
        address: ``HOST:PORT`` of this machine, or the path of a socket of the file system.
        seconds: Longest time to wait [s].

    Raises:
        PeerError: No program listens there, or the address is not one of this machine.
    """
    host, _, port = address.rpartition(":")
    try:
        if port.isdigit() and "/" not in address:
            if host.strip("[]") not in _LOCAL:
                what = f"is not on this machine: {host!r} is not one of {', '.join(_LOCAL)}"
                raise PeerError(what, f"start it on this machine and write 127.0.0.1:{port}")
            made = socket.create_connection((host.strip("[]"), int(port)), timeout=seconds)
        else:
            made = _connect_file(address, seconds)
    except (OSError, OverflowError, AttributeError) as error:  # some systems have no sockets of the file system
        fix = "start it first, and write HOST:PORT such as 127.0.0.1:9000, or the path of its socket"
        raise PeerError(f"does not listen there: {error}", fix) from error
    made.settimeout(None)
    reader, writer = made.makefile("rb"), made.makefile("wb", buffering=0)

    def close() -> None:
        with contextlib.suppress(OSError):
            made.shutdown(socket.SHUT_RDWR)
        for one in (writer, made):  # the thread closes the reader, from which it may be reading
            with contextlib.suppress(OSError):
                one.close()

    return Channel(reader, writer, close)


def _connect_file(path: str, seconds: float) -> socket.socket:
    made = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        made.settimeout(seconds)
        made.connect(path)
    except BaseException:
        made.close()
        raise
    return made


def _talk(
    reader: BinaryIO,
    writer: Writer,
    asked: queue.SimpleQueue[bytes | None],
    answers: queue.SimpleQueue[bytes | Exception],
) -> None:
    """Send each line that is asked for and read one line after it, until there is nothing more to ask."""
    with reader:
        while (line := asked.get()) is not None:
            try:
                with contextlib.suppress(OSError):  # what a program said before it ended is read nevertheless
                    write_to_pipe(writer, line + b"\n")
                answer = reader.readline(MAX_LINE_BYTES + 1)
            except (OSError, ValueError) as error:  # closed at the other end, or by this one
                answers.put(OSError(str(error)))
                return
            if len(answer) > MAX_LINE_BYTES:
                answers.put(ValueError(f"answered with a line of more than {MAX_LINE_BYTES:,} bytes"))
                return
            answers.put(answer)


def _ended(child: Child) -> str:
    """How a process has ended whose output is closed, in words."""
    how, code = child.how_ended(), child.process.returncode
    if code is None:
        return "has closed its output"
    return f"has ended with {how}" if code >= 0 else f"was ended by {how}"
