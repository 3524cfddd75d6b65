"""Blocks of code of a Markdown text, with the comments before them that say what they are."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

__all__ = ["Fence", "commands_of", "execute", "fences_of"]

ROOT = Path(__file__).resolve().parents[2]
_FENCE = re.compile(
    r"(?:<!-- (?P<kind>file|not run|command): (?P<about>[^>]*?) -->\n)?"
    r"^(?P<indent> *)```(?P<language>[\w{}-]*)\n(?P<text>.*?)^(?P=indent)```",
    re.DOTALL | re.MULTILINE,
)


class Fence(NamedTuple):
    """One block: its language, its text, and what a comment says: the file that it is, or why it is not run."""

    language: str
    text: str
    kind: str
    about: str


def fences_of(text: str) -> Iterator[Fence]:
    for match in _FENCE.finditer(text):
        content = re.sub(f"^{match['indent']}", "", match["text"], flags=re.MULTILINE)
        yield Fence(match["language"], content, match["kind"] or "", match["about"] or "")


def commands_of(text: str) -> Iterator[list[str]]:
    """Commands of irsim in a block for a terminal, as words; a backslash or an open quote goes on in the next line."""
    waiting = ""
    for line in text.replace("\\\n", " ").splitlines():
        reader = shlex.shlex(waiting + line, posix=True, punctuation_chars="|&;")
        reader.whitespace_split = True
        try:
            words = list(reader)
        except ValueError:  # a quote is open
            waiting += f"{line}\n"
            continue
        waiting, command = "", list[str]()
        for word in [*words, ";"]:
            if set(word) <= set("|&;"):
                if command[:1] == ["irsim"]:
                    yield command
                command = []
            else:
                command.append(word)


def execute(command: list[str], folder: Path, timeout: float = 240) -> str:
    """Run a command or a program of a page in a folder; returns what it prints, and fails if it fails."""
    env = {**os.environ, "MPLBACKEND": "Agg", "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=timeout, env=env)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout
