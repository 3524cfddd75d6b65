"""The programs of an answer: which there are, whether they only run scenarios, and what they print."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from irsim.common.child import kill_group
from irsim_evals.grader.episode_log import Started, read_log
from irsim_evals.grader.program_rules import problems_of

__all__ = ["SECONDS", "Printed", "is_program", "problems_in", "rehearse_program", "run_program"]

SECONDS = 40.0
"""Time that one program gets."""
_MAX_PRINTED = 200_000
"""Number of characters of the output that are kept."""
_PROGRAMS = (".py", ".ipynb", ".sh", ".js", ".pl", ".rb", ".bat", ".ps1")


@dataclass(frozen=True)
class Printed:
    """What came of running a program.

    Attributes:
        passed: Whether it ended by itself, and without an error.
        text: What it printed.
        why: Why it did not pass.
        ended: Whether it ended by itself.
        episodes: The episodes that it started in a rehearsal.
    """

    passed: bool
    text: str
    why: str = ""
    ended: bool = True
    episodes: Sequence[Started] = ()


def is_program(name: str) -> bool:
    """Whether a file is a program, by its name."""
    return name.lower().endswith(_PROGRAMS)


def problems_in(texts: Mapping[str, str], given: Mapping[str, str], allowed: str) -> list[str]:
    """What is wrong with the programs of an answer.

    Args:
        texts: Files of the answer.
        given: Files that it started with.
        allowed: ``none`` or ``runner``.
    """
    names = [name for name in texts if is_program(name) and given.get(name) != texts[name]]
    if allowed == "none":
        return [f"{name} is a program" for name in names]
    found = []
    for name in names:
        if not name.endswith(".py"):
            found.append(f"{name} is no Python program")
        else:
            found += [f"{name}, {problem}" for problem in problems_of(texts[name])]
    return found


def run_program(folder: Path, name: str, seconds: float = SECONDS) -> Printed:
    """Run a program in a folder, in processes that end with it.

    Args:
        folder: Folder with the files of the answer.
        name: Path of the program in it.
        seconds: Time after which it is ended.
    """
    return _run(folder, name, seconds, None)


def rehearse_program(folder: Path, name: str, seconds: float = SECONDS) -> Printed:
    """Run a program as :func:`run_program` does, but simulate nothing, and find out which episodes it starts."""
    with tempfile.TemporaryDirectory(prefix="irsim-evals-") as outside:  # where the program may not write
        return _run(folder, name, seconds, Path(outside, "episodes.jsonl"))


def _run(folder: Path, name: str, seconds: float, log: Path | None) -> Printed:
    command = [sys.executable, "-I", "-m", "irsim_evals.grader.run_program", name, *([str(log)] if log else [])]
    environment = {"PATH": os.defpath, "MPLBACKEND": "Agg", "HOME": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    with (folder / ".printed").open("wb") as output:
        process = subprocess.Popen(
            command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT,
            start_new_session=True,
        )  # fmt: skip
        try:
            code: int | None = process.wait(seconds)
        except subprocess.TimeoutExpired:
            code = None
        finally:
            _end(process)
    with (folder / ".printed").open("rb") as printed:
        text = printed.read(_MAX_PRINTED).decode("utf-8", errors="replace")
    episodes = read_log(log) if log else []
    if code is None:
        return Printed(False, text, f"{name} did not end within {seconds:g} s", ended=False, episodes=episodes)
    if code != 0:
        lines = text.strip().splitlines()
        why = f"{name} ended with exit code {code}: {lines[-1] if lines else ''}"[:300]
        return Printed(False, text, why, episodes=episodes)
    return Printed(True, text, episodes=episodes)


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a process with all that it started."""
    kill_group(process.pid)
    process.wait()
