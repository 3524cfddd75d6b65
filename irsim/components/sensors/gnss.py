"""``gnss``: satellite navigation."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field

import irsim._core as core
from irsim.components.sensors._gauges import GaugeOptions
from irsim.options.base import problem
from irsim.options.registry import SENSORS
from irsim.options.units import Bool, Meters, Number, Seconds
from irsim.options.vectors import Component, Offset, vector

Error = Annotated[Meters, Field(ge=0)]
Names = Annotated[list[str], Field(max_length=100)]


def _is_on_earth(origin: list[float]) -> list[float]:
    if abs(origin[0]) > 90 or abs(origin[1]) > 180:
        raise problem(
            "out-of-range",
            f"no place on the earth has latitude {origin[0]:g} and longitude {origin[1]:g}",
            allowed="latitudes from -90 to 90, longitudes from -180 to 180",
            fix="origin: [48.1, 11.6, 520]",
        )
    return origin


class Gnss(GaugeOptions):
    """Satellite navigation: a position with an error that wanders slowly and noise on top, x east and y north.

    `quality` is 0 without reception (x and y are NaN), 1 alone, and with `rtk` 2 or 3, as corrections come and go.
    """

    locates: ClassVar[bool] = True
    zone_keys: ClassVar[tuple[str, ...]] = ("blocked", "reflecting")
    reports: ClassVar[tuple[str, ...]] = ("x", "y", "quality", "std")
    report_units: ClassVar[tuple[str, ...]] = ("m", "m", "1", "m")
    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "gnss", "std": 0.5, "drift_std": 2.0}]}

    name: Literal["gnss"] = "gnss"
    offset: Offset = [0.0, 0.0, 0.0]
    """Place of the antenna in the body frame: [x, y, theta]."""
    std: Error = 0.5
    """Standard deviation of the noise of each coordinate, drawn for each reading."""
    drift_std: Error = 2.0
    """Standard deviation, in the long run, of the error that wanders (Gauss-Markov), of each coordinate."""
    drift_time: Annotated[Seconds, Field(gt=0)] = 600.0
    """Time in which the wandering error forgets itself (to 1/e)."""
    rtk: Bool = False
    """Corrections from a base station: there is no wandering error while they last, and `quality` says which."""
    fixed_std: Error = 0.015
    """Standard deviation with all corrections (`quality` 3)."""
    fixed_time: Annotated[Seconds, Field(ge=0)] = 60.0
    """Mean time for which all corrections last; 0 is for ever."""
    float_std: Error = 0.3
    """Standard deviation with some corrections (`quality` 2)."""
    float_time: Annotated[Seconds, Field(ge=0)] = 10.0
    """Mean time until all corrections are back; 0 is for ever."""
    blocked: Names = []
    """Names of regions among `world.zones` without reception."""
    reflecting: Names = []
    """Names of regions in which reflections from walls make the errors larger."""
    reflection: Annotated[Number, Field(ge=1, le=100)] = 3.0
    """How many times larger they are there."""
    origin: Annotated[list[Component], vector(("deg", "deg", "m"), 3), AfterValidator(_is_on_earth)] = [0.0, 0.0, 0.0]
    """Latitude, longitude and height of the origin of the world, for messages of ROS."""


SENSORS.register(Gnss, kernel=core.GnssOptions)
