"""Number types of the scenario language: each carries its unit into schema, descriptions and errors.

``Meters`` and its siblings are plain floats for pydantic, strict (no strings, no booleans) and finite.
Add bounds with ``Annotated[Meters, Field(gt=0)]``.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

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
