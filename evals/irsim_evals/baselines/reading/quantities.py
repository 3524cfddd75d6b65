"""Numbers with units in the text of a request, in m, s, rad and kg."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Literal

__all__ = ["NUMBER", "Kind", "Quantity", "quantities"]

Kind = Literal["length", "speed", "angle", "turn", "time", "rate", "share", "mass", "count"]

NUMBER = r"[-+]?\d+(?:\.\d+)?"
"""A number as :func:`.language.plain` leaves it."""

_UNITS: list[tuple[str, Kind, float]] = [
    (r"km/h|kph|kmh|kilomet\w+ per hour|km por hora|公里/小时|公里每小时|千米每小时|千米/小时", "speed", 1 / 3.6),
    (r"cm/s|厘米/秒", "speed", 0.01),
    (r"m/s|met(?:re|er)s? per second|meter pro sekunde|metros por segundo|米/秒|米每秒", "speed", 1.0),
    (r"mph", "speed", 0.44704),
    (
        r"(?:°|deg(?:rees?)?|grad|grados)\s?(?:/\s?s|per second|pro sekunde|por segundo)|度/秒|度每秒",
        "turn",
        math.pi / 180,
    ),
    (r"rad(?:ians?)?\s?(?:/\s?s|per second)|弧度/秒", "turn", 1.0),
    (r"°|deg(?:rees?)?\b|grad\b|grados?\b|度", "angle", math.pi / 180),
    (r"rad(?:ians?)?\b|弧度", "angle", 1.0),
    (r"hz\b|hertz\b|赫兹", "rate", 1.0),
    (r"ms\b|milliseconds?\b|毫秒", "time", 0.001),
    (r"min(?:ut\w+)?\b|分钟", "time", 60.0),
    (r"s\b|sec(?:onds?)?\b|sekunden?\b|segundos?\b|秒", "time", 1.0),
    (r"cm\b|centimet\w+\b|zentimetern?\b|centímetros?\b|厘米", "length", 0.01),
    (r"mm\b|millimet\w+\b|milímetros?\b|毫米", "length", 0.001),
    (r"km\b|kilomet\w+\b|公里|千米", "length", 1000.0),
    (r"ft\b|feet\b|foot\b", "length", 0.3048),
    (r"inch(?:es)?\b|in\.(?=\s)", "length", 0.0254),
    (r"yd\b|yards?\b", "length", 0.9144),
    (r"m\b|met(?:re|er)n?s?\b|metros?\b|米", "length", 1.0),
    (r"%|percent\b|per cent\b|prozent\b|por ciento\b", "share", 0.01),
    (r"kg\b|kilogram\w*\b|千克|公斤", "mass", 1.0),
]  # fmt: skip
_ANY_UNIT = "|".join(f"(?P<u{i}>{unit})" for i, (unit, _, _) in enumerate(_UNITS))
_QUANTITY = re.compile(rf"(?<![a-zà-ÿ\d_.])({NUMBER})(?:[\s-]?(?:{_ANY_UNIT}))?")


@dataclass(frozen=True)
class Quantity:
    """A number of a text.

    Attributes:
        value: In m, s, rad or kg and quotients of them; a share as a fraction.
        kind: What its unit measures; ``count`` without a unit.
        start, end: Where it stands in the text.
    """

    value: float
    kind: Kind
    start: int
    end: int


def quantities(text: str) -> list[Quantity]:
    """All numbers of a text that :func:`.language.plain` made, in their order."""
    found = []
    for match in _QUANTITY.finditer(text):
        unit = next((i for i in range(len(_UNITS)) if match[f"u{i}"] is not None), None)
        kind: Kind = "count" if unit is None else _UNITS[unit][1]
        factor = 1.0 if unit is None else _UNITS[unit][2]
        found.append(Quantity(round(float(match[1]) * factor, 9), kind, match.start(), match.end()))
    return found
