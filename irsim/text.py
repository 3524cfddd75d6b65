"""Text from scenario files, fit to be shown."""

from __future__ import annotations

__all__ = ["clean"]


def clean(text: object, longest: int = 80) -> str:
    """One line without control characters, which could play tricks on a terminal or a reader, and not endless.

    Args:
        text: A name or a message.
        longest: Characters to keep.
    """
    shown = "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in str(text))
    return shown if len(shown) <= longest else shown[: longest - 3] + "..."
