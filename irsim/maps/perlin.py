"""``perlin``: procedural noise."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.maps._options import MapOptions
from irsim.registry import MAPS
from irsim.units import Fraction, Integer, Meters, Number


class PerlinMap(MapOptions):
    """Cave-like walls from gradient noise."""

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "perlin", "resolution": 0.2, "fill": 0.3, "seed": 7}]
    }

    name: Literal["perlin"] = "perlin"
    resolution: Annotated[Meters, Field(gt=0)]
    """Cell size."""
    complexity: Annotated[Number, Field(gt=0, json_schema_extra={"x-unit": "1/cell"})] = 0.142857
    """Frequency of the noise: larger makes smaller rooms."""
    fill: Fraction = 0.38
    """Share of occupied cells."""
    fractal: Annotated[Integer, Field(ge=1, le=32)] = 1
    """Octaves of finer and finer detail."""
    attenuation: Annotated[Number, Field(gt=0)] = 0.5
    """Amplitude of detail k is this divided by k + 1."""
    seed: Annotated[Integer, Field(ge=0)] | None = None
    """Seed of the noise alone; null draws it from the environment's map stream."""


MAPS.register(PerlinMap)
