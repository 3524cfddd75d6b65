"""Output of the commands: consoles, JSON, and a progress bar that appears only for longer work."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from irsim.common.text import escape_marks

if TYPE_CHECKING:
    from pydantic import BaseModel
    from rich.console import Console
    from rich.progress import Progress

__all__ = [
    "OUTCOME_COLORS",
    "console",
    "existing",
    "has_colors",
    "is_terminal",
    "prepare_streams",
    "print_error",
    "print_json",
    "progress",
    "show_written",
    "silence_stdout",
    "size_text",
]

OUTCOME_COLORS = {"success": "green", "collision": "red", "timeout": "yellow"}
"""Colour of each outcome of an episode."""
_PROGRESS_DELAY_S = 1.0
"""Time after which a progress bar appears [s]."""
_LINE_PERIOD_S = 30.0
"""Time between two lines of progress where there is no terminal [s]."""


def prepare_streams() -> None:
    """Make printing safe: characters that the encoding of the terminal lacks, or that mislead readers, are escaped.

    A closed stream loses the text that is printed to it, as in a service without a terminal.
    """
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, ValueError):
            stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
            stream.write = _escaping(stream.write)  # type: ignore[method-assign]


def _escaping(write: Callable[[str], int]) -> Callable[[str], int]:
    """A ``write`` that escapes marks which could mislead a reader, as JSON does."""

    def escaped(text: str) -> int:
        return write(text if text.isascii() else escape_marks(text))

    return escaped


def console(*, stderr: bool = False) -> Console:
    """Return a rich console on standard output or standard error, without markup and highlighting.

    On a terminal it breaks lines between words; elsewhere it leaves lines as they are. Print text that users copy with
    ``soft_wrap=True``, which never breaks lines.
    """
    from rich.console import Console as RichConsole

    class Console(RichConsole):
        def on_broken_pipe(self) -> None:  # rich would exit, but handle_errors decides on the exit code
            raise BrokenPipeError

    return Console(stderr=stderr, markup=False, highlight=False, soft_wrap=not is_terminal(stderr=stderr))


def print_error(code: str, message: str) -> None:
    """Print an error to standard error, in one line."""
    from rich.text import Text

    console(stderr=True).print(Text.assemble(("error ", "bold red"), (code, "bold"), f": {message}"))


def has_colors(stream: TextIO) -> bool:
    """Whether to print colors: the stream is a terminal, and NO_COLOR is not set."""
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def is_terminal(*, stderr: bool = False) -> bool:
    """Whether standard output or standard error is a terminal."""
    stream = sys.stderr if stderr else sys.stdout
    return stream.isatty()


def print_json(model: BaseModel, *, line: bool = False) -> None:
    """Print a result as one JSON document on standard output: indented on a terminal, otherwise in one line.

    Args:
        model: The result.
        line: Print one line on a terminal, too.
    """
    indent = 2 if is_terminal() and not line else None
    sys.stdout.write(model.model_dump_json(indent=indent) + "\n")


def existing(*files: str | Path | None) -> frozenset[str]:
    """The files of these names that exist now, before a command replaces them, for :func:`show_written`."""
    return frozenset(os.path.abspath(file) for file in files if file is not None and os.path.isfile(file))


def show_written(
    files: str | Path | Sequence[str], about: str = "", *, before: Collection[str] = (), stderr: bool = False
) -> None:
    """Print the paths of written files as all commands do, in one line that is never broken: ``wrote hall.gif (…)``.

    Args:
        files: One file or folder, or several; names below the current directory are shortened.
        about: Their content; default: the size of the files.
        before: Result of :func:`existing` before they were written; where it has one, the line says ``replaced``.
        stderr: Print to standard error instead of standard output.
    """
    from rich.text import Text

    names = [str(files)] if isinstance(files, (str, os.PathLike)) else list(files)
    here = os.getcwd() + os.sep
    shown = ", ".join(name.removeprefix(here) for name in names)
    out = console(stderr=stderr)
    if not about and all(map(os.path.isfile, names)):
        about = size_text(sum(map(os.path.getsize, names)))
    verb = "replaced" if any(os.path.abspath(name) in before for name in names) else "wrote"
    out.print(Text.assemble(f"{verb} ", (shown, "bold"), f" ({about})" if about else ""), soft_wrap=True)


def size_text(size: int) -> str:
    """The size of a file [bytes] in words: ``0.99 MB``, ``12 kB``."""
    return f"{size / 1e6:.2f} MB" if size >= 1e5 else f"{max(size / 1e3, 1):.0f} kB"


def silence_stdout() -> None:
    """Redirect standard output to nowhere after a write error, so that the final flush of Python does not fail."""
    with suppress(OSError, ValueError, AttributeError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


@contextmanager
def progress(label: str) -> Iterator[Callable[[int, int], None]]:
    """Show a progress bar on standard error if the work takes longer than a second; in a file, a line every 30 s.

    Args:
        label: Text before the bar, such as ``simulating``.

    Yields:
        Callback ``(done, total)``.
    """
    if not is_terminal(stderr=True):
        yield _lines(label)
        return
    bar = _Bar(label)
    timer = threading.Timer(_PROGRESS_DELAY_S, bar.show)
    timer.daemon = True
    timer.start()
    try:
        yield bar.update
    finally:
        timer.cancel()
        bar.close()


def _lines(label: str) -> Callable[[int, int], None]:
    """Callback ``(done, total)`` that prints a line from time to time."""
    due = time.monotonic() + _LINE_PERIOD_S

    def report(done: int, total: int) -> None:
        nonlocal due
        if time.monotonic() >= due:
            due = time.monotonic() + _LINE_PERIOD_S
            print(f"{label}: {done:,} of {total:,}", file=sys.stderr, flush=True)

    return report


class _Bar:
    """A rich progress bar; one thread can show it while another closes it."""

    def __init__(self, label: str) -> None:
        self._label = label
        self._lock = threading.Lock()
        self._state: tuple[int, int | None] = (0, None)
        self._bar: Progress | None = None
        self._closed = False

    def show(self) -> None:
        from rich.progress import (
            BarColumn,
            Progress,
            SpinnerColumn,
            TaskProgressColumn,
            TextColumn,
            TimeElapsedColumn,
            TimeRemainingColumn,
        )

        with self._lock:
            if self._closed:
                return
            self._bar = Progress(
                SpinnerColumn("line"),
                TextColumn("{task.description}"),
                BarColumn(),
                TaskProgressColumn(),
                TimeElapsedColumn(),
                TimeRemainingColumn(),
                console=console(stderr=True),
                transient=True,
            )
            self._bar.add_task(self._label, completed=self._state[0], total=self._state[1])
            self._bar.start()

    def update(self, done: int, total: int) -> None:
        self._state = (done, total)
        if self._bar is not None:
            self._bar.update(self._bar.task_ids[0], completed=done, total=total)

    def close(self) -> None:
        with self._lock:
            self._closed = True
            if self._bar is not None:
                self._bar.stop()
