"""Numbers in XML."""

from __future__ import annotations

__all__ = ["colored", "numbers"]


def numbers(*values: float) -> str:
    """Numbers separated by spaces, with twelve digits."""
    return " ".join(f"{value + 0.0:.12g}" for value in values)


def colored(color: tuple[float, float, float]) -> str:
    """An opaque color."""
    return numbers(*(round(value, 4) for value in color), 1)
