"""Sensors that report one range for a whole cone: keys that sonars and infrared sensors have in common."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar

from pydantic import Field

from irsim.components.sensors._gauges import GaugeOptions
from irsim.options.units import Fraction, Meters, Number, Radians
from irsim.options.vectors import Offset

__all__ = ["ConeOptions", "Share"]

Share = Annotated[Fraction, Field(lt=1)]
Length = Annotated[Meters, Field(ge=0)]


class ConeOptions(GaugeOptions):
    """A sensor that reports the distance to the nearest surface in a cone that returns anything."""

    reports: ClassVar[tuple[str, ...]] = ("range", "valid", "field_of_view")
    report_units: ClassVar[tuple[str, ...]] = ("m", "1", "rad")
    also_called: ClassVar[dict[str, str]] = {
        "range": "range_max",
        "max_range": "range_max",
        "min_range": "range_min",
        "fov": "cone",
        "field_of_view": "cone",
        "angle_range": "cone",
        "pose": "offset",
        "sigma": "std",
        "noise_std": "std",
    }

    offset: Offset = [0.0, 0.0, 0.0]
    """Mounting pose in the body frame: [x, y, theta]; the cone opens about its x axis."""
    range_min: Length = 0.02
    """Shortest range; a nearer surface reads this value and is not valid."""
    range_max: Annotated[Meters, Field(gt=0)] = 4.0
    """Greatest range; without an echo the sensor reads this value, which is not valid."""
    cone: Annotated[Radians, Field(ge=0, le=3)] = 0.2618
    """Full angle of the cone; 0 is a line."""
    incidence_max: Annotated[Radians, Field(gt=0, le=1.5708)] | None = None
    """Largest angle between a line from the sensor and the normal of the surface at which it returns anything; null:
    any. A wall that is more slanted is not seen."""
    std: Length = 0.0
    """Standard deviation of the range."""
    std_per_meter: Annotated[Number, Field(ge=0, le=1)] = 0.0
    """Growth of the noise with the range: the standard deviation is sqrt(std² + (std_per_meter · range)²)."""
    resolution: Length = 0.0
    """Ranges are multiples of this; 0 does not round."""
    dropout: Share = 0.0
    """Share of readings without an echo."""

    def resolved(self, zones: list[str]) -> dict[str, Any]:
        """Fields of the kernel that are not as they are written: a missing limit."""
        limit = math.inf if self.incidence_max is None else self.incidence_max
        return {**super().resolved(zones), "incidence_max": limit}
