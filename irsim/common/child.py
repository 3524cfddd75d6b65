"""Child processes: starting, talking to, limiting and ending them; each ends with its parent.

The effect of a limit depends on the system:

==================  ==========================================  ===========================================
limit               Linux, macOS                                Windows
==================  ==========================================  ===========================================
memory              address space (Linux; macOS ignores it)     none
processor time      the process is killed                       none
size of a file      writing beyond it fails                     none
open files          opening one more fails                      none
wall-clock time     the parent ends the process                 the parent ends the process
end of the parent   by standard input and the parent's number   by standard input
==================  ==========================================  ===========================================
"""

from __future__ import annotations

import json
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext, suppress
from typing import IO, Any, Protocol

from irsim.common.held import for_children

__all__ = [
    "ONE_THREAD",
    "Child",
    "Writer",
    "answers",
    "end_with_input",
    "end_with_parent",
    "how_ended",
    "kill_group",
    "limit",
    "lines",
    "python",
    "write_line",
    "write_to_pipe",
]

ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
"""Environment variables for a process that is one of many: its libraries start no threads of their own."""
_LOOK_S = 1.0
"""Time between two looks whether the parent still lives [s]."""
_GRACE_S = 1.0
"""Time for a process whose output is closed to end [s]."""


class Writer(Protocol):
    """A stream without a buffer, which may take only the first bytes."""

    def write(self, data: memoryview, /) -> int | None:
        """Write some bytes and return their number."""


# in the parent --------------------------------------------------------------------------------------------------------
def python(module: str) -> list[str]:
    """Command that calls ``main`` of a module in a new interpreter.

    It imports from the same places as this one, and holds the same folder (:mod:`irsim.common.held`).
    """
    isolated = ["-I"] if sys.flags.isolated else []
    start = f"import sys; sys.path[:] = {sys.path!r}; {for_children()[0]}from {module} import main; main()"
    return [sys.executable, *isolated, "-X", "utf8", "-c", start]


class Child:
    """A process with pipes to its standard input and from its standard output, which Ctrl-C at a terminal spares.

    Args:
        command: Program and arguments.
        start_new_session: Whether it gets a session of its own, so that what it has started ends with it. Otherwise
            it stays in the group of this process, and holds SIGINT back.
        options: Further arguments of :class:`subprocess.Popen`.

    Raises:
        OSError: It cannot be started.
    """

    def __init__(self, command: Sequence[str], *, start_new_session: bool = True, **options: Any) -> None:
        self._own_group = start_new_session
        self.process: subprocess.Popen[bytes]
        with nullcontext() if start_new_session else _without_interrupts():
            self.process = subprocess.Popen(
                list(command),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                bufsize=0,
                start_new_session=start_new_session,
                **{**options, "pass_fds": (*options.get("pass_fds", ()), *for_children()[1])},
            )
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.input: IO[bytes] = self.process.stdin
        self.output: IO[bytes] = self.process.stdout
        self._lines: queue.SimpleQueue[bytes] | None = None

    def send(self, line: bytes) -> bool:
        """Write a line, without its end, to standard input; False if the process does not read any more."""
        try:
            write_to_pipe(self.input, line + b"\n")
        except (OSError, ValueError):  # it has ended, or its input was closed
            return False
        return True

    def receive(self, seconds: float | None = None) -> bytes | None:
        """The next line of standard output with its end.

        Args:
            seconds: Longest time to wait [s]; None: until it comes.

        Returns:
            Empty if standard output is closed; None if the time is over.
        """
        if self._lines is None:
            self._lines = queue.SimpleQueue()
            threading.Thread(target=_read, args=(self.output, self._lines), daemon=True).start()
        try:
            line = self._lines.get(timeout=seconds)
        except queue.Empty:
            return None
        if not line:
            self._lines.put(b"")  # further calls get it, too
        return line

    def hang_up(self) -> None:
        """Close standard input, upon which a child of irsim ends by itself; a full pipe does not hold it up."""
        threading.Thread(target=_close, args=(self.input,), daemon=True).start()

    def kill(self) -> None:
        """Kill the process, and with a group of its own what it has started."""
        kill_group(self.process.pid) if self._own_group else self.process.kill()

    def end(self, grace: float = 0.0) -> None:
        """End the process and close the pipes.

        Args:
            grace: Time that it has to end by itself after standard input is closed [s].
        """
        self.hang_up()
        if grace:
            with suppress(subprocess.TimeoutExpired):
                self.process.wait(grace)
        self.kill()
        self.process.kill()  # where there are no groups
        self.process.wait()
        if self._lines is None:  # otherwise the thread that reads closes it
            _close(self.output)

    def how_ended(self) -> str:
        """How the process has ended whose output is closed, as :func:`how_ended` says it; waits for it a little."""
        with suppress(subprocess.TimeoutExpired):
            self.process.wait(_GRACE_S)
        return how_ended(self.process.returncode)


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """Hold back SIGINT, which processes that are started meanwhile do for all of their lives."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def how_ended(code: int | None) -> str:
    """The meaning of a return code: ``exit code 3``, ``signal 9``, or ``no exit code`` of a process that still runs."""
    if code is None:
        return "no exit code"
    return f"exit code {code}" if code >= 0 else f"signal {-code}"


def kill_group(pid: int) -> None:
    """Kill a process that has a session of its own, and what it has started; on Windows only the process."""
    with suppress(ProcessLookupError, PermissionError):
        if os.name == "posix":
            os.killpg(pid, signal.SIGKILL)
        else:
            os.kill(pid, signal.SIGTERM)


def _read(output: IO[bytes], lines: queue.SimpleQueue[bytes]) -> None:
    """Put the lines of a process into a queue, and an empty one at the end."""
    with suppress(OSError, ValueError), open(output.fileno(), "rb", closefd=False) as buffered:
        for line in buffered:
            lines.put(line)
    _close(output)
    lines.put(b"")


def _close(pipe: IO[bytes]) -> None:
    with suppress(OSError, ValueError):
        pipe.close()


def write_to_pipe(pipe: Writer, data: bytes) -> None:
    """Write all of the data to a pipe without a buffer, which may take only the first bytes.

    Raises:
        OSError: No process reads the pipe.
    """
    rest = memoryview(data)
    while rest:
        rest = rest[pipe.write(rest) or 0 :]


# in the child ---------------------------------------------------------------------------------------------------------
def answers() -> IO[bytes]:
    """The pipe to the parent; from now on what libraries and modules of the user print goes to standard error."""
    pipe = os.fdopen(os.dup(1), "wb", buffering=0)
    os.dup2(2, 1)
    return pipe


def write_line(pipe: Writer, message: Any) -> None:
    """Write a message as a line of JSON."""
    write_to_pipe(pipe, json.dumps(message).encode() + b"\n")


def lines() -> queue.SimpleQueue[bytes]:
    """The lines of standard input; the process ends at once when it is closed."""
    received: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(received,), daemon=True).start()
    return received


def _listen(received: queue.SimpleQueue[bytes]) -> None:
    for line in sys.stdin.buffer:
        received.put(line)
    os._exit(0)


def end_with_input() -> None:
    """End this process when standard input is closed, that is, when the parent has ended; what comes is not read."""
    threading.Thread(target=_drain, daemon=True).start()


def _drain() -> None:
    sys.stdin.buffer.read()
    os._exit(1)


def end_with_parent() -> None:
    """End this process when its parent has died, even if another process holds the pipe or a function hangs."""
    threading.Thread(target=_watch, args=(os.getppid(),), daemon=True).start()


def _watch(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(_LOOK_S)
    os._exit(0)


def limit(
    *, memory: int | None = None, cpu: int | None = None, written: int | None = None, files: int | None = None
) -> None:
    """Limit the resources of this process, and write no core files; see the table of this module.

    Args:
        memory: Address space [bytes].
        cpu: Processor time [s].
        written: Size of a file that is written [bytes].
        files: Number of open files.
    """
    if os.name != "posix":
        return
    import resource

    bounds = {
        resource.RLIMIT_AS: memory,
        resource.RLIMIT_CPU: cpu,
        resource.RLIMIT_FSIZE: written,
        resource.RLIMIT_NOFILE: files,
        resource.RLIMIT_CORE: 0,
    }
    for kind, most in bounds.items():
        if most is None:
            continue
        least = min(bound for bound in (*resource.getrlimit(kind), most) if bound != resource.RLIM_INFINITY)
        with suppress(ValueError, OSError):  # a system that has no limit of this kind
            resource.setrlimit(kind, (least, least))
