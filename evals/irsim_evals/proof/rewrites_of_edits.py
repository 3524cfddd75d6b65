"""Rewrites of the lines that an edit changed, and of line endings: the same edit, written otherwise."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Iterator

__all__ = ["rewrites_of_edit"]

_NUMBER = re.compile(r"(?<![\w.#\"'-])(-?\d+(?:\.\d+)?)(?![\w.:\"'])")
_KEY = re.compile(r"(?<![\w\"'])([a-z_]+): ")


def rewrites_of_edit(given: str, text: str) -> Iterator[tuple[str, str]]:
    """Name and text of each rewrite of an edited file.

    Args:
        given: The file before the edit.
        text: The file after it.
    """
    lines = text.splitlines()
    matcher = difflib.SequenceMatcher(None, given.splitlines(), lines, autojunk=False)
    changed = [k for tag, _, _, a, b in matcher.get_opcodes() if tag != "equal" for k in range(a, b)]

    def with_lines(change: Callable[[str], str]) -> str:
        return "\n".join(change(line) if k in changed else line for k, line in enumerate(lines)) + "\n"

    made = {
        "without a newline at the end": text.rstrip("\n"),
        "with carriage returns": text.replace("\n", "\r\n"),
        "numbers as floats": with_lines(lambda line: _numbers(line, lambda n: f"{float(n)}")),
        "numbers with an exponent": with_lines(lambda line: _numbers(line, lambda n: f"{float(n):.9e}")),
        "numbers with more digits": with_lines(lambda line: _numbers(line, lambda n: f"{float(n):.6f}")),
        "keys in quotes": with_lines(lambda line: _keys(line, r'"\1": ')),
        "more spaces after keys": with_lines(lambda line: _keys(line, r"\1:   ")),
        "spaces at the end of a line": with_lines(lambda line: f"{line}   "),
        "spaces within brackets": with_lines(lambda line: _within(line, "[]")),
        "spaces within braces": with_lines(lambda line: _within(line, "{}")),
        "a comment on the changed lines": with_lines(lambda line: line if "#" in line else f"{line}  # changed"),
    }  # fmt: skip
    yield from ((name, new) for name, new in made.items() if new != text)


def _numbers(line: str, change: Callable[[str], str]) -> str:
    """Change the numbers of a line that are not counts: those with the key ``number`` stay."""

    def one(found: re.Match[str]) -> str:
        before = line[: found.start()].rstrip()
        return found[0] if before.endswith(("number:", "group:", "seed:")) else change(found[1])

    return _code(line, lambda code: _NUMBER.sub(one, code))


def _keys(line: str, by: str) -> str:
    return _code(line, lambda code: _KEY.sub(by, code))


def _within(line: str, brackets: str) -> str:
    first, last = brackets[0], brackets[1]
    return _code(line, lambda code: code.replace(first, f"{first} ").replace(last, f" {last}"))


def _code(line: str, change: Callable[[str], str]) -> str:
    """Change a line up to its comment."""
    code, mark, comment = line.partition("#")
    return change(code) + mark + comment
