"""Units of users: what each is in the units of scenarios, and the conversion of quantities such as `12 ft`."""

from __future__ import annotations

import math
import re
from typing import NamedTuple

from irsim.lookup.answer import Answer

__all__ = ["UNIT_TABLE", "UNIT_WORDS", "unit_answer"]


class Unit(NamedTuple):
    """A unit that scenarios do not have."""

    names: str
    """Its names, separated by commas, without regular plurals; the first is its usual sign."""
    factor: float
    """Number of units of scenarios that it is."""
    to: str
    """Unit of scenarios."""


UNITS = (
    Unit("ft, feet, foot, ', fuß, fuss, pie, pied, 英尺, 呎", 0.3048, "m"),
    Unit('in, inch, inches, ", zoll, pulgada, pouce, 英寸, 吋', 0.0254, "m"),
    Unit("yd, yards", 0.9144, "m"),
    Unit("mile, meile, meilen, milla, 英里", 1609.344, "m"),
    Unit("cm, centimeter, centimetre, zentimeter, centímetro, 厘米", 0.01, "m"),
    Unit("mm, millimeter, millimetre, milímetro, 毫米", 0.001, "m"),
    Unit("km, kilometer, kilometre, kilómetro, 公里, 千米", 1000.0, "m"),
    Unit("mph, mi/h, miles per hour, 英里每小时", 0.44704, "m/s"),
    Unit("km/h, kph, kmh, kilometers per hour, kilometres per hour, stundenkilometer, 公里每小时", 1 / 3.6, "m/s"),
    Unit("kn, kt, knot, knoten, nudo, 节", 0.514444, "m/s"),
    Unit("ft/s, fps, feet per second", 0.3048, "m/s"),
    Unit("rpm, u/min, umdrehungen pro minute, revolutions per minute, 转每分", math.pi / 30, "rad/s"),
    Unit("deg/s, °/s, degrees per second, grad pro sekunde, grados por segundo", math.pi / 180, "rad/s"),
    Unit("deg, °, degree, grad, grado, 度", math.pi / 180, "rad"),
    Unit("min, minute, minuten, minuto, 分钟", 60.0, "s"),
    Unit("ms, millisecond, 毫秒", 0.001, "s"),
    Unit("lb, pound, 磅", 0.45359237, "kg"),
)

UNIT_TABLE = (
    "1 ft = 0.3048 m, 1 in = 0.0254 m, 1 mph = 0.447 m/s, 1 km/h = 0.2778 m/s, 1 kn = 0.5144 m/s, "
    "1 rpm = 0.1047 rad/s (a wheel of radius r rolls at rpm x 0.1047 x r m/s), "
    "degrees x 0.01745 = rad: 30 is 0.5236, 45: 0.7854, 60: 1.0472, 90: 1.5708, 180: 3.1416, 270: 4.7124, 360: 6.28318"
)
"""The units that users name most."""

_NAMES = {name: unit for unit in UNITS for name in unit.names.split(", ")}
_BY_NAME = {f"{name}s": unit for name, unit in _NAMES.items() if len(name) > 1} | _NAMES
UNIT_WORDS = ", ".join(
    name
    for name, unit in _NAMES.items()
    if unit.to not in ("rad", "s") and (len(name) > 2 or name in ("ft", "cm", "mm"))
)
"""Names of units that count within other words, too; others, such as `in`, only alone or after a number."""

_NUMBER = r"-?\d+(?:\.\d+)?"
_ANY = "|".join(re.escape(name) for name in sorted(_BY_NAME, key=len, reverse=True))
_QUANTITY = re.compile(rf"({_NUMBER}(?:\s*(?:x|×|by|to|-|and)\s*{_NUMBER})*)\s*[-]?\s*({_ANY})(?![^\W\d])")
_BETWEEN = re.compile(r"(?:\s|,|x|×|by|and|to)*")
"""Spaces, commas and words that may stand between quantities."""


def unit_answer(topic: str) -> Answer | None:
    """Convert a unit, or quantities with units, to the units of scenarios; None if the topic is another.

    Args:
        topic: ``mph``, ``12 ft``, ``10 x 20 feet``, ``10 ft by 12 ft``, ``5 ft 10 in``, ``270°``.
    """
    asked = " ".join(topic.lower().split())
    if asked in _BY_NAME:
        unit = _BY_NAME[asked]
        said = f"1 {asked} = {unit.factor:.6g} {unit.to}"
    else:
        parts = list(_QUANTITY.finditer(asked))
        if not parts or _BETWEEN.fullmatch(_QUANTITY.sub("", asked)) is None:
            return None
        to = _BY_NAME[parts[0][2]].to
        if any(_BY_NAME[part[2]].to != to for part in parts):
            return None
        if len(parts) > 1 and not _QUANTITY.sub("", asked).strip():  # 5 ft 10 in is one length
            if not all(map(_is_one, parts)):
                return None
            sizes = f"{sum(float(part[1]) * _BY_NAME[part[2]].factor for part in parts):.5g}"
        else:
            sizes = " x ".join(_converted(part[1], _BY_NAME[part[2]].factor) for part in parts)
        said = f"{asked} = {sizes} {to}"
    return Answer(
        topic=topic,
        kind="guide",
        title=said,
        text=f"Scenarios have m, s, m/s, rad, rad/s, kg. {UNIT_TABLE}.",
        see=["units"],
    )


def _is_one(part: re.Match[str]) -> bool:
    """Whether a quantity has one number."""
    return re.fullmatch(_NUMBER, part[1]) is not None


def _converted(numbers: str, factor: float) -> str:
    """Multiply each number of a text; a minus sign after a number is a dash."""
    return re.sub(r"(?<![\d\s])-?\d+(?:\.\d+)?|\d+(?:\.\d+)?", lambda one: f"{float(one[0]) * factor:.5g}", numbers)
