"""Colors as numbers, without loading a drawing library: the same that matplotlib draws."""

from __future__ import annotations

from typing import Any

__all__ = ["rgb"]

_NAMED = {
    "b": (0.0, 0.0, 1.0), "g": (0.0, 0.5, 0.0), "r": (1.0, 0.0, 0.0), "c": (0.0, 0.75, 0.75), "m": (0.75, 0.0, 0.75),
    "y": (0.75, 0.75, 0.0), "k": (0.0, 0.0, 0.0), "w": (1.0, 1.0, 1.0), "none": (0.0, 0.0, 0.0),
}  # fmt: skip
_TABLEAU = {
    "blue": "#1f77b4", "orange": "#ff7f0e", "green": "#2ca02c", "red": "#d62728", "purple": "#9467bd",
    "brown": "#8c564b", "pink": "#e377c2", "gray": "#7f7f7f", "olive": "#bcbd22", "cyan": "#17becf", "grey": "#7f7f7f",
}  # fmt: skip
_CYCLED = tuple(_TABLEAU.values())[:10]
"""The colors ``C0`` to ``C9``."""


def rgb(color: Any) -> tuple[float, float, float]:
    """Red, green and blue, 0 to 1, of a color as scenarios write it.

    Args:
        color: A name, ``#RRGGBB``, a grey level as text, or three or four numbers.

    Raises:
        ValueError: It is no color.
    """
    if not isinstance(color, str):
        red, green, blue, *_ = (float(value) for value in color)
        return red, green, blue
    if color in _NAMED:
        return _NAMED[color]
    if color.startswith("#"):
        return _of_digits(color[1:])
    if color.startswith("tab:") and color[4:] in _TABLEAU:
        return _of_digits(_TABLEAU[color[4:]][1:])
    if color[:1] == "C" and color[1:].isdecimal():
        return _of_digits(_CYCLED[int(color[1:]) % len(_CYCLED)][1:])
    if color[:1] in "01.":
        return (float(color),) * 3
    from PIL.ImageColor import colormap, getrgb

    if (name := color.lower()) in colormap:
        red, green, blue, *_ = (value / 255 for value in getrgb(name))
        return red, green, blue
    from matplotlib.colors import to_rgb  # knows the many names of xkcd, and takes half a second to load

    red, green, blue = to_rgb(color)
    return float(red), float(green), float(blue)


def _of_digits(digits: str) -> tuple[float, float, float]:
    width = 1 if len(digits) in (3, 4) else 2
    most = 16**width - 1
    red, green, blue = (int(digits[width * k : width * (k + 1)], 16) / most for k in range(3))
    return red, green, blue
