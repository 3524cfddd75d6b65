"""Makes text from scenario files fit to be shown."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

__all__ = [
    "cell",
    "clean",
    "decimal",
    "escape_marks",
    "listed",
    "markdown_code",
    "markdown_text",
    "metres",
    "names_if_different",
    "plural",
    "quoted",
    "rounded_pair",
    "seconds",
    "shorten_pair",
]

MAX_NAME = 40
"""Number of characters of a name that a message shows."""
_MIN_SENTENCE = 100
"""Number of characters from which on a text that is cut is a sentence, not a name or a value."""
_DECIMALS = 3
"""Decimals of numbers in lists of differences."""
_MOST_DECIMALS = 6
"""Number of decimals of a length at which two lengths count as equal."""


def shorten_pair(before: object, after: object, longest: int = 80) -> tuple[str, str]:
    """Two values as one line each; long ones are cut so that their first difference stays visible.

    Args:
        before: First value.
        after: Second value.
        longest: Number of characters to keep of each.
    """
    first, second = (clean(value, 10**6) for value in (before, after))
    if max(len(first), len(second)) <= longest:
        return first, second
    same = next(
        (i for i, (x, y) in enumerate(zip(first, second, strict=False)) if x != y), min(len(first), len(second))
    )
    start = max(0, same - longest // 4)
    if start > 3:
        first, second = "..." + first[start:], "..." + second[start:]
    return clean(first, longest), clean(second, longest)


def names_if_different(before: object, after: object) -> tuple[object, object]:
    """The names of two options with different names, one of which may be None; other values as they are.

    Args:
        before: First value.
        after: Second value.
    """
    names = [value.get("name") if isinstance(value, Mapping) else value for value in (before, after)]
    options = [value for value in (before, after) if value is not None]
    if options and names[0] != names[1] and all(isinstance(value, Mapping) and "name" in value for value in options):
        return names[0], names[1]
    return before, after


def rounded_pair(before: object, after: object) -> tuple[object, object]:
    """Two values with their numbers rounded to millimetres and milliradians, as they are if that made them equal.

    Args:
        before: First value, as JSON types.
        after: Second value.
    """
    short = _rounded(before), _rounded(after)
    return (before, after) if short[0] == short[1] else short


def _rounded(value: object) -> object:
    if isinstance(value, float):
        return round(value, _DECIMALS) + 0.0
    if isinstance(value, Mapping):
        return {key: _rounded(item) for key, item in value.items()}
    return [_rounded(item) for item in value] if isinstance(value, list) else value


def seconds(time: float) -> str:
    """A time as text, in the one format that all messages use: ``14.95 s``.

    Args:
        time: Time to format [s].
    """
    return f"{round(time, 2):.10g} s"


def metres(length: float, unlike: float | None = None) -> str:
    """A length as text, to the centimetre, and with two digits below 10 cm: ``1 m``, ``2.35 m``, ``0.083 m``.

    Args:
        length: Length to format [m]; one that was computed may miss a round number by a little.
        unlike: A length that differs, beside which it is read: as many decimals are shown as tell them apart.
    """
    shown = _metres(length, 2)
    if unlike is None or length == unlike:
        return shown
    decimals = 2
    while shown == _metres(unlike, decimals) and decimals < _MOST_DECIMALS:
        decimals += 1
        shown = _metres(length, decimals)
    return shown


def _metres(length: float, decimals: int) -> str:
    return f"{length:.{decimals}g} m" if abs(length) < 0.1 else f"{round(length, decimals):.10g} m"


def clean(text: object, longest: int = 80) -> str:
    """A text as one line of limited length, without control characters, which could mislead a terminal or a reader.

    A sentence that is too long ends after a whole word, so that no number loses its end.

    Args:
        text: A name or a message.
        longest: Number of characters to keep.
    """
    shown = "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in str(text))
    if len(shown) <= longest:
        return shown
    words = shown[: longest - 3].rpartition(" ")[0]
    return f"{words} ..." if len(words) > _MIN_SENTENCE else f"{shown[: longest - 3]}..."


_FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""Beginnings of cells that spreadsheets run as formulas."""
_MARKDOWN = {ord(mark): f"&#{ord(mark)};" for mark in "<>&|`"}
"""Marks of HTML, tables and code in Markdown as character references."""


_MARKS = {
    code: f"\\u{code:04x}"
    for code in (*range(0x80, 0xA0), 0x61C, 0x200E, 0x200F, *range(0x2028, 0x202F), *range(0x2066, 0x206A), 0xFEFF)
}
"""Control characters above ASCII and marks that change the direction of text, as JSON escapes them."""


def escape_marks(text: str) -> str:
    """A text of any length with such marks escaped; JSON stays JSON of the same value."""
    return text.translate(_MARKS)


def cell(text: str) -> str:
    """A name as a cell of a table of text that a spreadsheet may open: it is never a formula."""
    return f"'{text}" if text.startswith(_FORMULA) else text


def markdown_text(text: object) -> str:
    """A text as one line of Markdown that shows just this text: no HTML, no table, no code, no link."""
    shown = clean(text, 10**6).translate(_MARKDOWN)
    return shown.replace("](", "&#93;(").replace("][", "&#93;[")


def markdown_code(text: object) -> str:
    """A text as code in Markdown; its own backticks do not end it."""
    shown = clean(text, 10**6)
    fence = "`" * (1 + max(map(len, re.findall("`+", shown)), default=0))
    space = " " * (len(fence) > 1)
    return f"{fence}{space}{shown}{space}{fence}"


def quoted(name: object, longest: int = MAX_NAME) -> str:
    """Quote a name for a message: ``'scout'``.

    Args:
        name: The name.
        longest: Characters to keep.
    """
    return f"'{clean(name, longest)}'"


def plural(count: int, noun: str) -> str:
    """A number of things: ``1 error``, ``2 errors``."""
    return f"{count} {noun}{'s' * (count != 1)}"


def decimal(value: float, digits: int) -> str:
    """A number with at most ``digits`` digits after the point, without an exponent: ``0.5``, ``12``."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def listed(items: Sequence[str], most: int) -> str:
    """List words in a message and count the rest: ``a, b, c and 2 more``.

    Args:
        items: The words.
        most: Number of words to show.
    """
    more = f" and {len(items) - most} more" if len(items) > most else ""
    return ", ".join(items[:most]) + more
