"""Sensors that report numbers instead of ranges: keys that several of them have."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import Field

from irsim.components.sensors._timing import TimedOptions
from irsim.options.units import Number

__all__ = ["DriftOptions", "GaugeOptions"]

PerRootMeter = Annotated[Number, Field(ge=0, le=100, json_schema_extra={"x-unit": "m/sqrt(m)"})]
PerRootTurn = Annotated[Number, Field(ge=0, le=100, json_schema_extra={"x-unit": "rad/sqrt(m)"})]
PerRootRadian = Annotated[Number, Field(ge=0, le=100, json_schema_extra={"x-unit": "rad/sqrt(rad)"})]


class GaugeOptions(TimedOptions):
    """A sensor that reports a few numbers; programs read them by name."""

    reports: ClassVar[tuple[str, ...]] = ()
    """Names of its numbers, in their order; empty if they follow from the options."""
    report_units: ClassVar[tuple[str, ...]] = ()
    zone_keys: ClassVar[tuple[str, ...]] = ()
    """Keys that name zones of the world; the kernel has their numbers."""
    locates: ClassVar[bool] = False
    """Whether it tells where the robot itself is or how it moves, or where others are."""
    table: ClassVar[str] = ""
    """Key under which programs read rows of these numbers, of a sensor that reports several; empty: one row."""

    def numbers(self) -> tuple[tuple[str, str], ...]:
        """Name and unit of each of its numbers, in their order."""
        return tuple(zip(self.reports, self.report_units, strict=True))

    def resolved(self, zones: list[str]) -> dict[str, Any]:
        """Fields of the kernel that are not keys, or not as they are written.

        Args:
            zones: Names of the zones of the world.
        """
        return {key: [zones.index(name) for name in getattr(self, key) if name in zones] for key in self.zone_keys}


class DriftOptions(GaugeOptions):
    """Errors of a motion that add up: variances grow with the way and with the turn, whatever the step."""

    distance_noise: PerRootMeter = 0.0
    """Standard deviation of the distance after a way of 1 m; it grows with the square root of the way."""
    heading_noise: PerRootTurn = 0.0
    """Standard deviation of the heading after a way of 1 m."""
    turning_noise: PerRootRadian = 0.0
    """Standard deviation of the heading after a turn of 1 rad."""
