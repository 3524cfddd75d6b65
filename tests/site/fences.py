"""Blocks of code of a Markdown text, with the comments before them that say what they are."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from typing import NamedTuple

__all__ = ["Fence", "commands_of", "fences_of"]

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
