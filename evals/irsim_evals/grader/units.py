"""Quantities with units, as people write them in prompts: ``5.4 km/h``, ``90deg/s``, ``100ft``."""

from __future__ import annotations

import math
import re

__all__ = ["UNITS", "quantity"]

UNITS: dict[str, float] = {
    "m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0, "ft": 0.3048, "in": 0.0254, "yd": 0.9144,
    "rad": 1.0, "deg": math.pi / 180, "°": math.pi / 180, "turn": 2 * math.pi,
    "s": 1.0, "ms": 0.001, "min": 60.0, "h": 3600.0, "Hz": 1.0,
    "kg": 1.0, "g": 0.001, "%": 0.01, "": 1.0,
}  # fmt: skip
"""Factor from a unit to metres, radians, seconds, kilograms or 1."""
_QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\s\d/]*)(?:/([^\s\d/]+))?\s*")


def quantity(value: float | int | str) -> float:
    """A number in m, rad, s or kg (and quotients of them) from a number or a text with a unit.

    Raises:
        ValueError: The text is not a number with a known unit.
    """
    if isinstance(value, bool):
        raise ValueError(f"{value!r} is not a quantity")
    if isinstance(value, (int, float)):
        return float(value)
    found = _QUANTITY.fullmatch(value)
    if found is None:
        raise ValueError(f"{value!r} is not a number with a unit such as 5.4km/h")
    number, unit, per = found.groups()
    for name in filter(None, (unit, per)):
        if name not in UNITS:
            raise ValueError(f"{value!r}: the unit {name!r} is not known; known are {', '.join(filter(None, UNITS))}")
    return float(number) * UNITS[unit] / (UNITS[per] if per else 1.0)
