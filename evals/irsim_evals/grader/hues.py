"""How people see colors: everyday names, so that an answer may choose which orange, and which ones look different."""

from __future__ import annotations

import colorsys
import math
from collections.abc import Iterable

__all__ = ["HUES", "discernible", "hue_of"]

_HUES = (
    (15, "red"), (42, "orange"), (70, "yellow"), (165, "green"), (195, "cyan"), (262, "blue"), (315, "purple"),
    (345, "pink"), (360, "red"),
)  # fmt: skip
"""Upper end [degrees] of the part of the color circle that a name stands for."""
HUES = ("red", "orange", "yellow", "green", "cyan", "blue", "purple", "pink", "brown", "white", "grey", "black")
"""Everyday names of colors."""
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


_DISCERNIBLE = 8.0
"""Distance in CIELAB (1976) from which on small discs of two colors are told apart at a glance."""
_TO_XYZ = ((0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505))
_WHITE = (0.9505, 1.0, 1.089)
"""Linear sRGB → CIE XYZ, and the white point D65 (IEC 61966-2-1)."""


def hue_of(color: str | None) -> str | None:
    """The everyday name of a color, one of :data:`HUES`; None without a color.

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


def discernible(colors: Iterable[str | None]) -> list[str | None]:
    """Colors of which any two look different; colors that look like an earlier one are left out.

    Args:
        colors: As ``#rrggbb``; None and names of other kinds are compared as they are.
    """
    kept: list[str | None] = []
    for color in colors:
        if not any(color == other or _distance(color, other) < _DISCERNIBLE for other in kept):
            kept.append(color)
    return kept


def _distance(a: str | None, b: str | None) -> float:
    """Distance of two colors in CIELAB (CIE 76); infinite if one is not known."""
    if a is None or b is None or not (a.startswith("#") and b.startswith("#")):
        return math.inf
    return math.dist(_lab(a), _lab(b))


def _lab(color: str) -> tuple[float, float, float]:
    parts = [int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in parts]
    xyz = (sum(map(float.__mul__, row, linear)) / white for row, white in zip(_TO_XYZ, _WHITE, strict=True))
    x, y, z = (v ** (1 / 3) if v > (6 / 29) ** 3 else v / (3 * (6 / 29) ** 2) + 4 / 29 for v in xyz)
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)
