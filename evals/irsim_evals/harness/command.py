"""The command ``irsim`` as the only program of an agent: in its folder, with limits of time and memory, offline."""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
from pathlib import Path

from irsim_evals.grader.limited import LimitError, run_limited
from irsim_evals.harness.folder import FolderError

__all__ = ["run_command"]

_COMMANDS = (
    "templates", "new", "validate", "diff", "run", "inspect", "benchmark", "suites", "policies", "render", "describe",
)  # fmt: skip
"""Commands that need neither a network nor code of the agent."""
_REFUSED = re.compile(
    r"--(?:import|bridge|cluster|show|export|install-completion|show-completion)\b"  # code, networks, windows
    r"|\.\.|(?:^|=|^-[a-z])[/~]"  # places outside the folder
    r"|\.py\b|^[\w.]+:\w"  # policies that are programs
)
_SECONDS = 60.0
"""Processor time of one command [s]."""
_MAX_OUTPUT = 16_000
"""Characters of the output that the agent gets."""


def run_command(folder: Path, line: str) -> str:
    """Run a line such as ``irsim validate scenario.yaml`` in a folder; returns what it prints.

    Raises:
        FolderError: The line is not allowed, or the command ended with an error; the text says why.
    """
    try:
        words = shlex.split(line)
    except ValueError as error:
        raise FolderError(f"{line!r} is not a command line: {error}") from None
    words = words[1:] if words[:1] == ["irsim"] else words
    if not words or (words[0] not in _COMMANDS and words != ["--help"]):
        raise FolderError(f"the commands are {', '.join(f'irsim {name}' for name in _COMMANDS)}, without pipes")
    for word in words:
        if _REFUSED.search(word):
            raise FolderError(f"{word} is not allowed here: only files of your folder, no programs and no network")
    try:
        code, text = run_limited(_run, (str(folder), words), _SECONDS, "command")
    except LimitError as error:
        raise FolderError(str(error)) from None
    text = text if len(text) <= _MAX_OUTPUT else f"{text[:_MAX_OUTPUT]}\n[cut]"
    if code:
        raise FolderError(f"{text.rstrip()}\n[exit code {code}]")
    return text or "[no output]"


def _run(folder: str, words: list[str]) -> tuple[int, str]:
    """Run a command in the limited process; exit code, and what it printed."""
    from irsim.cli.app import app

    os.chdir(folder)
    os.environ.update(COLUMNS="120", HOME=str(Path(folder).parent), MPLBACKEND="Agg")
    printed = io.StringIO()
    code: object = 0
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
        try:
            app(words, prog_name="irsim")
        except SystemExit as end:
            code = end.code
    return (code if isinstance(code, int) else int(code is not None)), printed.getvalue()
