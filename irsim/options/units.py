"""Number types of the scenario language: each carries its unit into schema, descriptions and errors.

``Meters`` and its siblings are plain floats for pydantic, strict (no strings, no booleans) and finite.
Add bounds with ``Annotated[Meters, Field(gt=0)]``.
"""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import AfterValidator, Field

from irsim.common.angles import FULL_TURN
from irsim.options.base import problem

__all__ = [
    "Bool",
    "Count",
    "Degrees",
    "Fraction",
    "Hertz",
    "Integer",
    "Kilograms",
    "Meters",
    "MetersPerSecond",
    "MetersPerSecondSquared",
    "Number",
    "Pixels",
    "Points",
    "Radians",
    "RadiansPerSecond",
    "Seconds",
    "SpanAngle",
    "is_span",
    "unit",
]


def unit(symbol: str) -> object:
    """Field metadata that puts ``x-unit: symbol`` into the JSON Schema."""
    return Field(json_schema_extra={"x-unit": symbol}, strict=True, allow_inf_nan=False)


Number = Annotated[float, unit("1")]
Meters = Annotated[float, unit("m")]
Radians = Annotated[float, unit("rad")]
Degrees = Annotated[float, unit("deg")]
Seconds = Annotated[float, unit("s")]
Hertz = Annotated[float, unit("1/s")]
MetersPerSecond = Annotated[float, unit("m/s")]
MetersPerSecondSquared = Annotated[float, unit("m/s^2")]
RadiansPerSecond = Annotated[float, unit("rad/s")]
Kilograms = Annotated[float, unit("kg")]
Pixels = Annotated[float, unit("px")]
Points = Annotated[float, unit("pt")]
Fraction = Annotated[float, Field(strict=True, ge=0, le=1, json_schema_extra={"x-unit": "1"})]
Integer = Annotated[int, Field(strict=True, json_schema_extra={"x-unit": "1"})]
Count = Annotated[Integer, Field(ge=0)]
Bool = Annotated[bool, Field(strict=True)]

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
