"""Text from scenario files, fit to be shown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

__all__ = ["clean", "kinds", "listed", "pair", "quoted", "seconds"]

MAX_NAME = 40
"""Number of characters of a name that a message shows."""


def pair(before: object, after: object, longest: int = 80) -> tuple[str, str]:
    """Two values on a line each, long ones cut so that what differs is seen.

    Args:
        before: One.
        after: The other.
        longest: Characters to keep of each.
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


def kinds(before: object, after: object) -> tuple[object, object]:
    """Of options of two kinds, or of some and none, what they are: their names. Other values stay as they are.

    Args:
        before: One value.
        after: The other.
    """
    names = [value.get("name") if isinstance(value, Mapping) else value for value in (before, after)]
    options = [value for value in (before, after) if value is not None]
    if options and names[0] != names[1] and all(isinstance(value, Mapping) and "name" in value for value in options):
        return names[0], names[1]
    return before, after


def seconds(time: float) -> str:
    """A time in words, the same one everywhere: ``14.95 s``.

    Args:
        time: It [s].
    """
    return f"{round(time, 2):.10g} s"


def clean(text: object, longest: int = 80) -> str:
    """One line without control characters, which could play tricks on a terminal or a reader, and not endless.

    Args:
        text: A name or a message.
        longest: Characters to keep.
    """
    shown = "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in str(text))
    return shown if len(shown) <= longest else shown[: longest - 3] + "..."


def quoted(name: object, longest: int = MAX_NAME) -> str:
    """Quote a name for a message: ``'scout'``.

    Args:
        name: The name.
        longest: Characters to keep.
    """
    return f"'{clean(name, longest)}'"


def listed(items: Sequence[str], most: int) -> str:
    """List words in a message and count the rest: ``a, b, c and 2 more``.

    Args:
        items: The words.
        most: Number of words to show.
    """
    more = f" and {len(items) - most} more" if len(items) > most else ""
    return ", ".join(items[:most]) + more
