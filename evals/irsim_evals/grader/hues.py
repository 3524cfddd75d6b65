"""Everyday names of colors, so that a prompt may say "orange" and an answer may choose which orange."""

from __future__ import annotations

import colorsys

__all__ = ["hue_of"]

_HUES = (
    (15, "red"), (42, "orange"), (70, "yellow"), (165, "green"), (195, "cyan"), (262, "blue"), (315, "purple"),
    (345, "pink"), (360, "red"),
)  # fmt: skip
"""Upper end [degrees] of the part of the color circle that a name stands for."""
_MAX_GREY_SATURATION = 0.23
"""Saturation below which a color is white, grey or black."""
_MAX_BLACK = 0.15
"""Value below which a color is black."""
_MIN_WHITE = 0.95
"""Value from which on an unsaturated color is white."""
_MAX_PINK_SATURATION = 0.5
"""Saturation below which a light red is pink."""
_MAX_BROWN = 0.72
"""Value below which a red or orange color that is not fully saturated is brown."""
_MAX_BROWN_SATURATION = 0.95
"""Saturation from which on a dark red or orange is not called brown."""


def hue_of(color: str | None) -> str | None:
    """The everyday name of a color: ``red``, ``orange``, ``yellow``, ``green``, ``cyan``, ``blue``, ``purple``,
    ``pink``, ``brown``, ``white``, ``grey`` or ``black``; None without a color.

    Args:
        color: As ``#rrggbb``.
    """
    if color is None or len(color) != 7 or not color.startswith("#"):
        return None
    red, green, blue = (int(color[k : k + 2], 16) / 255 for k in (1, 3, 5))
    hue, saturation, value = colorsys.rgb_to_hsv(red, green, blue)
    if value < _MAX_BLACK:
        return "black"
    if saturation < _MAX_GREY_SATURATION:
        return "white" if value >= _MIN_WHITE else "grey"
    name = next(name for end, name in _HUES if 360 * hue <= end)
    if name in ("red", "orange") and value < _MAX_BROWN and saturation < _MAX_BROWN_SATURATION:
        return "brown"
    return "pink" if name == "red" and saturation < _MAX_PINK_SATURATION else name
