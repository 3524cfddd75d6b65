"""Error handling of all commands: one clear message and the right exit code instead of a traceback."""

from __future__ import annotations

import functools
import json
import os
import shlex
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn, ParamSpec, TypeVar

import typer

from irsim.cli.output import print_error, silence_stdout
from irsim.common.files import is_disk_full
from irsim.common.text import clean
from irsim.diagnostics.errors import IrsimError, ScenarioError, ScenarioNotFoundError, said_by_core

__all__ = [
    "FAILED",
    "INTERRUPTED",
    "INVALID",
    "again",
    "ended_in_order",
    "going_on",
    "handle_errors",
    "say_interrupted",
]

FAILED = 1
"""Exit code of a command that could not finish."""
INVALID = 2
"""Exit code after invalid input."""
INTERRUPTED = 130
"""Exit code after Ctrl-C."""

P = ParamSpec("P")
R = TypeVar("R")


def handle_errors(command: Callable[P, R]) -> Callable[P, R]:
    """Decorate a command, so that exceptions become messages and exit codes.

    The exit code is 2 for invalid input, 130 for Ctrl-C and 1 for other errors; a closed output pipe is not an error.
    With ``--json`` the error is also printed to standard output as a JSON object. ``IRSIM_TRACEBACK=1`` does not
    handle exceptions, so that Python prints the traceback.
    """

    @functools.wraps(command)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            result = command(*args, **kwargs)
            sys.stdout.flush()
            return result
        except KeyboardInterrupt as stop:
            say_interrupted(getattr(stop, "go_on", f"again: {again()}"))
            raise typer.Exit(INTERRUPTED) from None
        except BrokenPipeError:
            silence_stdout()
            raise typer.Exit(0) from None
        except Exception as error:
            if isinstance(error, _HANDLED_BY_TYPER) or os.environ.get("IRSIM_TRACEBACK"):
                raise
            raise typer.Exit(_report(error, as_json=bool(kwargs.get("json_output")))) from None

    return call


@contextmanager
def going_on(command: Callable[[], str]) -> Iterator[None]:
    """Have Ctrl-C name the command that goes on with what runs here.

    Args:
        command: Returns the end of the sentence: what is kept, and the command.
    """
    try:
        yield
    except KeyboardInterrupt as stop:
        stop.go_on = command()  # type: ignore[attr-defined] # read by handle_errors
        raise


def again(extra: Sequence[str] = ()) -> str:
    """The words of this command, as a user types them.

    Args:
        extra: Further words.
    """
    return shlex.join(["irsim", *sys.argv[1:], *extra])


def say_interrupted(go_on: str) -> None:
    """Print that a command was interrupted, in one line, and leave the end of the process undisturbed.

    Args:
        go_on: How to go on.
    """
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    typer.echo(f"interrupted; {go_on}", err=True)


@contextmanager
def ended_in_order() -> Iterator[None]:
    """Let SIGTERM and SIGHUP end what runs as an exception does: bridges are closed, and files completed.

    The exit code is 128 and the number of the signal, as shells have it. A signal that is ignored remains so.
    """
    changed = []
    if threading.current_thread() is threading.main_thread():
        for number in filter(None, (getattr(signal, name, None) for name in ("SIGTERM", "SIGHUP"))):
            if signal.getsignal(number) is signal.SIG_DFL:
                signal.signal(number, _end)
                changed.append(number)
    try:
        yield
    finally:
        for number in changed:
            signal.signal(number, signal.SIG_DFL)


def _end(number: int, frame: Any) -> NoReturn:
    signal.signal(number, signal.SIG_IGN)  # what has begun to end is not interrupted
    raise SystemExit(128 + number)


_FAILURES = frozenset({"bridge-lost", "disk-full", "file-access", "no-cluster", "not-writable", "worker-failed"})
"""Codes of errors that are not about the input: the same command may succeed later."""
_HANDLED_BY_TYPER = (typer.Exit, typer.Abort, typer.BadParameter)


def _report(error: BaseException, *, as_json: bool) -> int:
    """Print an error and return the exit code."""
    code, message, exit_code = _describe(error)
    if isinstance(error, ScenarioError):
        from irsim.cli.findings import print_diagnostics

        print_diagnostics(error.diagnostics, error.source, stderr=True)
    else:
        print_error(code, message)
    if as_json:
        data: dict[str, object] = {"code": code, "message": message}
        if isinstance(error, IrsimError):
            data["findings"] = [diagnostic.as_dict() for diagnostic in error.diagnostics]
        try:
            typer.echo(json.dumps({"error": data}, indent=2, default=str))
            sys.stdout.flush()
        except OSError:  # the message is on standard error anyway
            silence_stdout()
    return exit_code


def _describe(error: BaseException) -> tuple[str, str, int]:
    """Return code, message and exit code of an exception."""
    if isinstance(error, ScenarioError):
        first = error.diagnostics[0]
        return first.code, first.message, INVALID
    if isinstance(error, ScenarioNotFoundError):
        return "file-not-found", str(error), INVALID
    if isinstance(error, IrsimError):
        text = str(error).removeprefix(f"{error.code}: ")
        return error.code, text, FAILED if error.code in _FAILURES else INVALID
    if isinstance(error, MemoryError):
        return "out-of-memory", ": ".join(filter(None, ["not enough memory", said_by_core(error)])) + ".", FAILED
    if is_disk_full(error):
        where = f" ({clean(name, 200)})" if (name := getattr(error, "filename", None)) else ""
        return "disk-full", f"no space is left on the disk{where}. Free some, or write to another disk.", FAILED
    if isinstance(error, OSError):
        where = f" ({clean(error.filename, 200)})" if error.filename else ""
        return "file-access", f"{error.strerror or error}{where}", FAILED
    frame = _frame_of(error)
    return (
        "internal-error",
        f"{type(error).__name__}: {error} ({frame}). Set IRSIM_TRACEBACK=1 to see the traceback.",
        FAILED,
    )


def _frame_of(error: BaseException) -> str:
    """Return file and line of an error: the innermost frame in user code, if any, otherwise the innermost of all."""
    frames = traceback.extract_tb(error.__traceback__)
    package = str(Path(__file__).resolve().parents[1])
    own = [f for f in frames if not f.filename.startswith(package) and "site-packages" not in f.filename]
    frame = next((f for f in reversed(own) if Path(f.filename).is_file()), frames[-1])
    return f"{frame.filename}:{frame.lineno}"
