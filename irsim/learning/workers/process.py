"""A worker process, as its parent sees it and as it runs, and the messages that they exchange over pipes."""

from __future__ import annotations

import os
import pickle
import select
import signal
import struct
import sys
import threading
from collections.abc import Sequence
from typing import Any

from irsim.common.child import ONE_THREAD, Child, answers, end_with_parent, python
from irsim.diagnostics.errors import WorkerError
from irsim.learning.workers.memory import SharedMemory
from irsim.learning.workers.part import Part, python_parts
from irsim.learning.worlds import Worlds

__all__ = ["DONE", "Worker", "main", "packed_error", "read_message", "stop", "write_message"]

DONE = b"\0"
"""First byte of an answer: the command was carried out. Any other one is followed by an error as a message."""
_LENGTH = struct.Struct("<Q")
_BUFFER = 65536


def write_message(file: int, message: Any, first: bytes = b"") -> None:
    """Write a message to a pipe, after some bytes.

    Raises:
        OSError: The pipe has no reader.
    """
    data = pickle.dumps(message, pickle.HIGHEST_PROTOCOL)
    rest = memoryview(first + _LENGTH.pack(len(data)) + data)
    while rest:
        rest = rest[os.write(file, rest) :]


def read_message(file: int) -> Any:
    """Read a message from a pipe.

    Raises:
        EOFError: The pipe was closed.
    """
    (length,) = _LENGTH.unpack(read_exactly(file, _LENGTH.size))
    return pickle.loads(read_exactly(file, length))


def read_exactly(file: int, length: int) -> bytes:
    """Read a number of bytes from a pipe.

    Raises:
        EOFError: The pipe was closed.
    """
    parts, left = [], length
    while left:
        part = os.read(file, min(left, _BUFFER))
        if not part:
            raise EOFError
        parts.append(part)
        left -= len(part)
    return parts[0] if len(parts) == 1 else b"".join(parts)


def packed_error(error: BaseException) -> Any:
    """An error as a message: its class, arguments and attributes, and its text in case that those cannot be sent."""
    text = f"{type(error).__name__}: {error}"
    given = (type(error), error.args, error.__dict__)
    try:
        return (*given, text) if isinstance(_rebuilt(*pickle.loads(pickle.dumps(given))), type(error)) else (text,)
    except Exception:  # classes of users may do anything here
        return (text,)


def unpacked_error(message: Any) -> BaseException:
    """The same error in another process; a RuntimeError with its text if it could not be sent."""
    *given, text = message
    return _rebuilt(*given) if given else RuntimeError(text)


def _rebuilt(kind: type[BaseException], args: tuple[Any, ...], values: dict[str, Any]) -> BaseException:
    """An error made without its constructor, whose arguments are not known."""
    error = kind.__new__(kind, *args)
    error.args = args
    error.__dict__.update(values)
    return error


_GRACE_S = 2.0
"""Time that a process has to end by itself [s]."""
_LOOK_MS = 500
"""Time between looks whether a process that does not answer still lives [ms]."""


class Worker:
    """A process that is started at once, and does not outlive this one.

    Args:
        files: Files that it inherits.

    Raises:
        WorkerError: It cannot be started.
    """

    def __init__(self, files: Sequence[int]) -> None:
        try:  # Ctrl-C at a terminal reaches only the parent
            self._child = Child(python("irsim.learning.workers.process"), pass_fds=files, env=os.environ | ONE_THREAD)
        except OSError as error:
            raise WorkerError(f"a worker process cannot be started: {error}", "give fewer workers") from error
        self._commands, self._answers = self._child.input.fileno(), self._child.output.fileno()
        self._waiting: Any = None
        if hasattr(select, "poll"):  # not on Windows
            self._waiting = select.poll()
            self._waiting.register(self._answers, select.POLLIN)

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._child.process.pid

    def send(self, message: Any) -> None:
        """Send a command.

        Raises:
            WorkerError: The process has died.
        """
        try:
            write_message(self._commands, message)
        except OSError:
            raise self._lost() from None

    def receive(self) -> BaseException | None:
        """Wait for the answer to a command: the error that it raised, or None.

        Raises:
            WorkerError: The process has died.
        """
        try:
            while self._waiting is not None and not self._waiting.poll(_LOOK_MS):
                if self._child.process.poll() is not None and not self._waiting.poll(0):
                    raise EOFError  # it has died, and a process that it started holds the pipe open
            if read_exactly(self._answers, 1) == DONE:
                return None
            return unpacked_error(read_message(self._answers))
        except (EOFError, OSError):
            raise self._lost() from None

    def _lost(self) -> WorkerError:
        what = f"a worker process of the environment has died ({self._child.how_ended()})"
        return WorkerError(what, "check the memory and your own modules, then make a new environment")

    def hang_up(self) -> None:
        """Close its input, upon which the process ends by itself."""
        self._child.hang_up()

    def end(self) -> None:
        """Wait a little for the process to end, and end it if it does not."""
        self._child.end(_GRACE_S)


def stop(workers: list[Worker], owner: int) -> None:
    """End processes; nothing in a process that was forked from that which started them.

    Args:
        workers: The processes; empty afterwards.
        owner: The process that started them.
    """
    if os.getpid() != owner:
        return
    for worker in workers:
        worker.hang_up()
    for worker in workers:
        worker.end()
    workers.clear()


_EXIT_S = 1.0
"""Time for the interpreter to end by itself [s]."""


def main() -> None:
    """Carry out commands."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is a matter of the parent
    pipe = answers()
    end_with_parent()
    try:
        _serve(pipe.fileno())
    except (EOFError, OSError):  # the parent has closed the pipes, or does not live any more
        end = threading.Timer(_EXIT_S, os._exit, (0,))
        end.daemon = True
        end.start()


def _serve(pipe: int) -> None:
    setup: dict[str, Any] = read_message(0)
    try:
        sys.argv = setup["argv"]  # files of scenarios are looked for beside the script, too
        worlds = Worlds(setup["task"], setup["n"], seed=setup["seed"], threads=setup["threads"], level=setup["level"])
        if python_parts(worlds) != setup["python"]:
            raise RuntimeError("the program that made the environment has registered behaviors, sensors or drives")
    except BaseException as error:
        read_message(0)
        write_message(pipe, packed_error(error), b"\1")
        return
    layout = read_message(0)
    memory = SharedMemory(setup["memory"])
    part = Part(worlds, setup["number"], setup["first"], layout, memory.arrays(layout))
    memory.close()
    os.write(pipe, DONE)
    while True:
        command = read_message(0)
        try:
            part.do(command)
        except BaseException as error:  # of a function of the user, SystemExit too: it is raised in the parent
            write_message(pipe, packed_error(error), b"\1")
        else:
            os.write(pipe, DONE)
