"""``localization``: where a robot believes it is on its map."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.sensors._gauges import DriftOptions
from irsim.options.registry import SENSORS
from irsim.options.units import Meters, Number, Radians, Seconds


class Localization(DriftOptions):
    """Pose on a map, as of a particle filter: smooth between corrections, with a small jump at each of them.

    A correction comes after some motion. Its error is drawn anew bit by bit (it forgets itself in `time`), and in
    between the pose drifts as odometry does. `jumps_per_km` adds gross errors, which fade in `time`.
    """

    locates: ClassVar[bool] = True
    reports: ClassVar[tuple[str, ...]] = ("x", "y", "theta", "corrected")
    report_units: ClassVar[tuple[str, ...]] = ("m", "m", "rad", "1")
    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "localization", "position_std": 0.05, "heading_std": 0.02, "heading_noise": 0.02}]
    }

    name: Literal["localization"] = "localization"
    position_std: Annotated[Meters, Field(ge=0)] = 0.05
    """Standard deviation of each coordinate after a correction."""
    heading_std: Annotated[Radians, Field(ge=0)] = 0.02
    """Standard deviation of the heading after a correction."""
    time: Annotated[Seconds, Field(ge=0)] = 5.0
    """Time in which this error forgets itself (to 1/e); 0 draws it anew at each correction."""
    min_distance: Annotated[Meters, Field(ge=0)] = 0.25
    """Way since the last correction that brings the next one."""
    min_turn: Annotated[Radians, Field(ge=0)] = 0.2
    """Turn since the last correction that brings the next one."""
    jumps_per_km: Annotated[Number, Field(ge=0)] = 0.0
    """How many gross errors there are on a way of 1 km, on average."""
    jump_std: Annotated[Meters, Field(ge=0)] = 1.0
    """Standard deviation of each coordinate of a gross error."""


SENSORS.register(Localization, kernel=core.LocalizationOptions)
