"""Widths of texts from the outlines of their letters, which are the same on every canvas and at every resolution."""

from __future__ import annotations

import re

from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextToPath

__all__ = ["TextSizes"]

MAX_KNOWN = 5000
_SIZE = 100.0
_DIGITS = re.compile(r"[1-9]")
"""All digits are as wide as a zero."""


class TextSizes:
    """Measures texts, each once."""

    def __init__(self) -> None:
        self._paths = TextToPath()
        self._known: dict[tuple[str, bool, bool], float] = {}

    def width(self, text: str, size: float, *, bold: bool = False, italic: bool = False) -> float:
        """Width of a text in the unit of its size."""
        key = _DIGITS.sub("0", text), bold, italic
        if key not in self._known:
            if len(self._known) >= MAX_KNOWN:
                self._known.clear()
            font = FontProperties(
                size=_SIZE, weight="bold" if bold else "normal", style="italic" if italic else "normal"
            )
            width, _, _ = self._paths.get_text_width_height_descent(key[0], font, False)
            self._known[key] = float(width) / _SIZE
        return self._known[key] * size
