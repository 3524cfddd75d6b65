"""What every verb does when something goes wrong: one clear message, the right exit code, never a traceback."""

from __future__ import annotations

import functools
import json
import os
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import ParamSpec, TypeVar

import typer

from irsim.cli.output import silence_stdout
from irsim.common.text import clean
from irsim.diagnostics.errors import IrsimError, ScenarioError, ScenarioNotFoundError

__all__ = ["FAILED", "INTERRUPTED", "INVALID", "guarded"]

FAILED, INVALID, INTERRUPTED = 1, 2, 130

P = ParamSpec("P")
R = TypeVar("R")


def guarded(verb: Callable[P, R]) -> Callable[P, R]:
    """A verb whose exceptions become messages and exit codes.

    Invalid input exits 2, anything else that goes wrong 1, Ctrl-C 130; a reader that closed the pipe is no error.
    With ``--json`` the error is a JSON object on standard output too. ``IRSIM_TRACEBACK=1`` lets exceptions through.
    """

    @functools.wraps(verb)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            result = verb(*args, **kwargs)
            sys.stdout.flush()
            return result
        except KeyboardInterrupt:
            typer.echo("interrupted", err=True)
            raise typer.Exit(INTERRUPTED) from None
        except BrokenPipeError:
            silence_stdout()
            raise typer.Exit(0) from None
        except Exception as error:
            if isinstance(error, _PASS) or os.environ.get("IRSIM_TRACEBACK"):
                raise
            raise typer.Exit(_report(error, as_json=bool(kwargs.get("json_output")))) from None

    return call


_PASS = (typer.Exit, typer.Abort, typer.BadParameter)


def _report(error: BaseException, *, as_json: bool) -> int:
    """Print an error; returns the exit code."""
    code, message, exit_code = _describe(error)
    if isinstance(error, ScenarioError):
        from irsim.cli.findings import print_diagnostics

        print_diagnostics(error.diagnostics, error.source, stderr=True)
    else:
        from rich.text import Text

        from irsim.cli.output import console

        console(stderr=True).print(Text.assemble(("error ", "bold red"), (code, "bold"), f": {message}"))
    if as_json:
        data: dict[str, object] = {"code": code, "message": message}
        if isinstance(error, ScenarioError):
            data["findings"] = [diagnostic.as_dict() for diagnostic in error.diagnostics]
        try:
            typer.echo(json.dumps({"error": data}, indent=2, default=str))
            sys.stdout.flush()
        except OSError:  # it went to standard error in words
            silence_stdout()
    return exit_code


def _describe(error: BaseException) -> tuple[str, str, int]:
    """Code, message and exit code of an exception."""
    if isinstance(error, ScenarioError):
        first = error.diagnostics[0]
        return first.code, first.message, INVALID
    if isinstance(error, ScenarioNotFoundError):
        return "file-not-found", str(error), INVALID
    if isinstance(error, IrsimError):
        code = getattr(error, "code", None)
        text = str(error)
        if not code:
            return "invalid-input", text, INVALID
        return str(code), text.removeprefix(f"{code}: "), FAILED if code == "file-access" else INVALID
    if isinstance(error, MemoryError):
        return "out-of-memory", "not enough memory for this.", FAILED
    if isinstance(error, OSError):
        where = f" ({clean(error.filename, 200)})" if error.filename else ""
        return "file-access", f"{error.strerror or error}{where}", FAILED
    frame = _frame_of(error)
    return (
        "internal-error",
        f"{type(error).__name__}: {error} ({frame}). IRSIM_TRACEBACK=1 shows how it came to that.",
        FAILED,
    )


def _frame_of(error: BaseException) -> str:
    """Where it happened: the innermost line of the user's own code if there is one, else of ours."""
    frames = traceback.extract_tb(error.__traceback__)
    package = str(Path(__file__).resolve().parents[1])
    own = [f for f in frames if not f.filename.startswith(package) and "site-packages" not in f.filename]
    frame = next((f for f in reversed(own) if Path(f.filename).is_file()), frames[-1])
    return f"{frame.filename}:{frame.lineno}"
