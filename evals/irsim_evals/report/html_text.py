"""Pieces of HTML from untrusted texts: everything is escaped, long texts are cut with a sentence."""

from __future__ import annotations

import difflib
import html
import math
from collections.abc import Collection
from decimal import Decimal

from irsim.bundled.templates.fill import parse_path
from irsim.common.text import clean
from irsim.common.yaml.nodes import Node
from irsim.scenario.limits import Limits
from irsim.scenario.yaml.document import Document, load_text

__all__ = [
    "UNITS", "code", "difference", "escaped", "lines_of", "note", "number", "one_line", "part", "percent", "prose",
]  # fmt: skip

UNITS = {
    "tokens": "tokens", "calls": "calls", "errors": "failed calls", "seconds": "seconds",
    "turns": "answers of the model", "input_tokens": "tokens read", "output_tokens": "tokens written",
    "cache_tokens": "tokens cached", "dollars": "US dollars",
}  # fmt: skip
"""Names of costs as the report prints them; others keep their own."""
_MAX_LINES = 400
_MAX_CHARACTERS = 40_000
"""Length of a text that the page shows."""
_MAX_LINE = 400
"""Characters of a line that the page shows."""
_MAX_COMPARED_LINES = 1500
"""Lines of a file that is compared with the one before."""
_MAX_PARSED = 100_000
"""Characters of a scenario in which lines are looked up."""


def escaped(text: object, longest: int = 2000) -> str:
    """A text in one line, without control characters, for an element or an attribute."""
    return html.escape(one_line(str(text)[: longest + 1], longest), quote=True)


def one_line(text: str, longest: int) -> str:
    """A text in one line without control characters, which could reorder what a reader sees."""
    return clean("".join(" " if c.isspace() else c for c in text), longest)


def note(html: str) -> str:
    """A paragraph in small letters."""
    return f'<p class="note">{html}</p>'


def part(title: str, html: str) -> str:
    """Something that a click on its title opens."""
    return f'<details class="part"><summary>{title}</summary>{html}</details>'


def prose(text: str) -> str:
    """A text of several lines, such as a prompt or a reply."""
    lines, rest = _cut(text)
    return '<pre class="prose">' + "\n".join(html.escape(line) for line in lines) + "</pre>" + _rest(rest)


def code(text: str, marked: Collection[int] = ()) -> str:
    """A file with numbered lines, of which some are marked by their numbers, from 1 on."""
    lines, rest = _cut(text)
    kinds = [' class="marked"' * (number in marked) for number in range(1, len(lines) + 1)]
    parts = [f"<span{kind}>{html.escape(line)}</span>" for kind, line in zip(kinds, lines, strict=True)]
    return '<pre class="code" tabindex="0">' + "\n".join(parts) + "</pre>" + _rest(rest)


def difference(before: str, after: str) -> str:
    """The changes of a file, line by line; a sentence if nothing did."""
    old, new = before.splitlines(), after.splitlines()
    if old == new:
        return note("The file is the one that was given.")
    if max(len(old), len(new)) > _MAX_COMPARED_LINES:
        return note(f"A file of more than {_MAX_COMPARED_LINES} lines is not compared.")
    changes = list(difflib.unified_diff(old, new, lineterm="", n=2))[2:]
    lines, rest = _cut("\n".join(changes))
    kinds = {"+": "added", "-": "removed", "@": "hunk"}
    parts = [f'<span class="{kinds.get(line[:1], "same")}">{html.escape(line)}</span>' for line in lines]
    return '<pre class="code diff" tabindex="0">' + "\n".join(parts) + "</pre>" + _rest(rest)


def lines_of(text: str, paths: Collection[str]) -> dict[str, range]:
    """Lines of a scenario that each path stands for, such as ``robot[0].state``; paths that are not there are left out.

    A scenario that is too long or that no YAML parser reads has no lines.
    """
    if not paths or len(text) > _MAX_PARSED:
        return {}
    try:
        document = load_text(text, limits=Limits(bytes=_MAX_PARSED, events=_MAX_PARSED, expansion=20_000, aliases=1000))
        if document.fatal:
            return {}
        return {path: lines for path in paths if (lines := _lines(document, path)) is not None}
    except Exception:  # marks are a help to the eye: a file that cannot be read again is shown without them
        return {}


def _lines(document: Document, path: str) -> range | None:
    """Lines of a value; the line of the innermost part that is there if it is missing."""
    parts = (*document.prefix, *parse_path(path))
    node, first = document.tree(), document.mark(parts, key=True)
    if node is None or first is None or not parts or str(parts[0]) not in map(str, node.children):
        return None
    for part in parts:
        inner = next((child for key, child in node.children.items() if str(key) == str(part)), None)
        if inner is None:
            return range(first.line, first.line + 1)
        node = inner
    return range(first.line, max(first.line, _last_line(node)) + 1)


def _last_line(node: Node) -> int:
    """Greatest line of any value below a node."""
    return max([node.mark.line, *map(_last_line, node.children.values())])


def number(value: float) -> str:
    """A number with at most three digits after a small part, and thousands kept together."""
    if abs(value) >= 1e15:
        return f"{Decimal(value):.3g}"  # a damaged file may hold a number that no float can be
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"


def percent(share: float) -> str:
    """A share as a percentage; a dash where nothing is known."""
    return "–" if math.isnan(share) else f"{share:.0%}".replace("%", " %")


def _cut(text: str) -> tuple[list[str], int]:
    """The first lines of a text as they are shown, and how many are left out."""
    lines = text[:_MAX_CHARACTERS].splitlines()
    shown = [one_line(line.replace("\t", "    "), _MAX_LINE) for line in lines[:_MAX_LINES]]
    return shown, text.count("\n") + 1 - len(shown) if len(shown) < len(lines) or len(text) > _MAX_CHARACTERS else 0


def _rest(lines: int) -> str:
    return note(f"{lines} more lines are in results.json.") if lines > 0 else ""
