"""Number types of the scenario language: each carries its unit into schema, descriptions and errors.

``Meters`` and its siblings are plain floats for pydantic, strict (no strings, no booleans) and finite. Each has a
largest magnitude, far above what worlds need and so far below overflow that products of a few numbers stay finite.
Add bounds with ``Annotated[Meters, Field(gt=0)]``.
"""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import AfterValidator, Field

from irsim.common.angles import FULL_TURN
from irsim.options.base import problem

__all__ = [
    "MAX_METERS",
    "MAX_SECONDS",
    "MAX_TOLD",
    "MAX_VERTICES",
    "MAX_WHOLE",
    "Bool",
    "Count",
    "Degrees",
    "Fraction",
    "Hertz",
    "Integer",
    "Kilograms",
    "LongInteger",
    "Meters",
    "MetersPerSecond",
    "MetersPerSecondSquared",
    "Number",
    "Pixels",
    "Points",
    "Radians",
    "RadiansPerSecond",
    "RadiansPerSecondSquared",
    "Seconds",
    "Seed",
    "SpanAngle",
    "Value",
    "is_span",
    "unit",
]

MAX_METERS = 1e9
"""Largest coordinate and length [m]; checks of places and speeds have narrower ones."""
MAX_SECONDS = 1e9
"""Longest time [s]: 31 years."""
MAX_TOLD = 1e6
"""Largest bound that descriptions and messages name; larger ones are named when a value is beyond them."""
MAX_VERTICES = 10_000
"""Most vertices of one shape."""
MAX_INTEGER = 2**31 - 1
"""Largest integer of the engine."""
MAX_WHOLE = 2**53
"""Largest whole number that every program reads exactly."""


def unit(symbol: str, most: float = 1e9) -> object:
    """Field metadata that puts ``x-unit: symbol`` into the JSON Schema, and bounds the magnitude by ``most``."""
    return Field(json_schema_extra={"x-unit": symbol}, strict=True, allow_inf_nan=False, ge=-most, le=most)


Number = Annotated[float, unit("1", 1e15)]
Meters = Annotated[float, unit("m", MAX_METERS)]
Radians = Annotated[float, unit("rad", 1e7)]
Degrees = Annotated[float, unit("deg", 1e7)]
Seconds = Annotated[float, unit("s", MAX_SECONDS)]
Hertz = Annotated[float, unit("1/s")]
MetersPerSecond = Annotated[float, unit("m/s", 1e7)]
MetersPerSecondSquared = Annotated[float, unit("m/s^2", 1e7)]
RadiansPerSecond = Annotated[float, unit("rad/s", 1e7)]
RadiansPerSecondSquared = Annotated[float, unit("rad/s^2", 1e7)]
Kilograms = Annotated[float, unit("kg")]
Pixels = Annotated[float, unit("px", 1e7)]
Points = Annotated[float, unit("pt", 1e7)]
Fraction = Annotated[float, Field(strict=True, ge=0, le=1, json_schema_extra={"x-unit": "1"})]
Integer = Annotated[int, Field(strict=True, ge=-MAX_INTEGER, le=MAX_INTEGER, json_schema_extra={"x-unit": "1"})]
LongInteger = Annotated[int, Field(strict=True, ge=-MAX_WHOLE, le=MAX_WHOLE, json_schema_extra={"x-unit": "1"})]
Count = Annotated[Integer, Field(ge=0)]
Seed = Annotated[int, Field(strict=True, ge=0, lt=2**64, json_schema_extra={"x-unit": "1"})]
Bool = Annotated[bool, Field(strict=True)]
Value = (
    bool
    | Annotated[int, Field(ge=-MAX_WHOLE, le=MAX_WHOLE)]
    | Annotated[float, Field(allow_inf_nan=False, ge=-MAX_WHOLE, le=MAX_WHOLE)]
    | str
)
"""The value of a parameter of a template."""

_ROUNDING = 0.02
"""Excess over a full turn that counts as rounding: 6.28, 6.2832 and 6.3 all mean a full turn [rad]."""


def is_span(angle: float) -> bool:
    """Whether an opening angle is at most a full turn, apart from rounding."""
    return angle <= FULL_TURN + _ROUNDING


def _clip(angle: float) -> float:
    if not is_span(angle):
        radians = min(round(math.radians(angle), 9), FULL_TURN) if 10 <= angle <= 360 else None
        degrees = "" if radians is None else f"; {angle:g} degrees are {radians:.5g} rad"
        raise problem(
            "angle-over-full-turn",
            f"{angle:g} rad is more than a full turn",
            allowed="0 to 6.28318 (2π) radians",
            fix=f"angles are in radians: a full turn is 6.28318{degrees}",
            replace=radians,
            tolerated_as=FULL_TURN,
        )
    return min(angle, FULL_TURN)


SpanAngle = Annotated[
    Radians, Field(ge=0), AfterValidator(_clip), Field(json_schema_extra={"maximum": round(FULL_TURN + _ROUNDING, 4)})
]
"""An opening angle from 0 to a full turn."""
