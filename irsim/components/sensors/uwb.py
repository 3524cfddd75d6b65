"""``uwb``: radio ranges to anchors."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.sensors._cones import Length, Share
from irsim.components.sensors._gauges import GaugeOptions
from irsim.options.registry import SENSORS
from irsim.options.units import Meters
from irsim.options.vectors import Offset, Point


class Uwb(GaugeOptions):
    """Ultra-wideband radio: the distance to each of some anchors, which walls and bodies on the way make longer.

    It reads `range_0`, `range_1`, … in the order of `anchors`; a range that is missing is NaN. Everything that is not
    `unobstructed` counts as a wall, but for the robot itself.
    """

    locates: ClassVar[bool] = True
    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "uwb", "anchors": [[0, 0], [10, 0], [5, 10]], "std": 0.05, "nlos_bias": 0.3}]
    }

    name: Literal["uwb"] = "uwb"
    anchors: Annotated[list[Point], Field(min_length=1, max_length=100)]
    """Places of the anchors, world frame."""
    offset: Offset = [0.0, 0.0, 0.0]
    """Place of the antenna in the body frame: [x, y, theta]."""
    range_max: Annotated[Meters, Field(gt=0)] = 100.0
    """Greatest distance at which an anchor is heard."""
    std: Length = 0.0
    """Standard deviation of a range along a free line of sight; usual are 0.03 to 0.1."""
    nlos_bias: Length = 0.0
    """The length that each wall or body on the straight way adds to a range; usual are 0.1 to 0.5."""
    nlos_std: Length = 0.0
    """Standard deviation that each wall or body adds, as a variance."""
    outlier_share: Share = 0.0
    """Share of ranges that are too long by chance, as by reflections."""
    outlier_mean: Length = 1.0
    """By how much these are too long on average: exponentially."""
    dropout: Share = 0.0
    """Share of ranges that are missing."""

    def numbers(self) -> tuple[tuple[str, str], ...]:
        """Name and unit of each of its numbers: one for each anchor."""
        return tuple((f"range_{k}", "m") for k in range(len(self.anchors)))


SENSORS.register(Uwb, kernel=core.UwbOptions)
