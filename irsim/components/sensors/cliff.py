"""``cliff``: points under a robot that see whether there is floor."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.sensors._cones import Share
from irsim.components.sensors._gauges import GaugeOptions
from irsim.options.registry import SENSORS
from irsim.options.vectors import Point


class Cliff(GaugeOptions):
    """Cliff sensors: points of the body that see the floor, which ends in regions among `world.zones`.

    It reads `drop_0`, `drop_1`, … in the order of `points`: 1 over such a region, else 0. Nothing falls: what a robot
    does about a drop is up to its program.
    """

    zone_keys: ClassVar[tuple[str, ...]] = ("zones",)
    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "cliff", "points": [[0.2, -0.1], [0.2, 0.1]], "zones": ["stairs"]}]
    }

    name: Literal["cliff"] = "cliff"
    points: Annotated[list[Point], Field(min_length=1, max_length=100)] = [[0.2, 0.0]]
    """Points that look down, in the body frame."""
    zones: Annotated[list[str], Field(max_length=100)] = []
    """Names of regions among `world.zones` without floor: stairs, the edge of a table."""
    miss_share: Share = 0.0
    """Share of readings over a drop that see floor."""
    false_share: Share = 0.0
    """Share of readings over floor that see a drop, as on dark carpets."""

    def numbers(self) -> tuple[tuple[str, str], ...]:
        """Name and unit of each of its numbers: one for each point."""
        return tuple((f"drop_{k}", "1") for k in range(len(self.points)))


SENSORS.register(Cliff, kernel=core.CliffOptions)
