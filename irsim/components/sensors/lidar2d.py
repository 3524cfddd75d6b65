"""``lidar2d``: a planar range scanner."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

import irsim._core as core
from irsim.components.sensors._devices import DEVICES, DeviceName, with_card
from irsim.components.sensors._realism import LidarRealism
from irsim.components.sensors._timing import TimedOptions
from irsim.options.base import Options
from irsim.options.colors import Color
from irsim.options.registry import SENSORS
from irsim.options.units import Bool, Fraction, Integer, Meters, Radians, Seconds, SpanAngle
from irsim.options.vectors import Offset


class BeamPlot(Options):
    """How a lidar's beams are drawn."""

    alpha: Fraction | None = None
    """Opacity of the beams; null is the `alpha` of the sensor."""
    color: Color | None = None
    """Colour of the beams; null is the `color` of the sensor."""


class Lidar2d(TimedOptions):
    """Planar lidar: `number` beams spread over `angle_range`, with a beam at both ends unless `endpoint` is false.

    Index 0 is the rightmost.
    """

    is_lidar: ClassVar[bool] = True

    also_called: ClassVar[dict[str, str]] = {
        **TimedOptions.also_called,
        "range": "range_max",
        "max_range": "range_max",
        "reach": "range_max",
        "min_range": "range_min",
        "beams": "number",
        "num_beams": "number",
        "n_beams": "number",
        "rays": "number",
        "samples": "number",
        "resolution": "number",
        "angle": "angle_range",
        "fov": "angle_range",
        "opening": "angle_range",
        "pose": "offset",
        "position": "offset",
        "noise_std": "std",
        "sigma": "std",
    }
    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [
            {"name": "lidar2d", "number": 181, "range_max": 8.0},
            {"name": "lidar2d", "number": 360, "range_max": 8.0, "angle_range": 6.28318, "endpoint": False},
        ]
    }

    name: Literal["lidar2d"] = "lidar2d"
    device: DeviceName | None = None
    """A lidar that one can buy: beams, ranges, noise and `realism` of its card; keys beside it win."""
    range_min: Annotated[Meters, Field(ge=0)] = 0.0
    """Shortest range; a nearer hit reads this value and is not valid."""
    range_max: Annotated[Meters, Field(gt=0)] = 10.0
    """Length of the beams; a beam that hits nothing reads this value."""
    angle_range: SpanAngle = 3.141592653589793
    """Total opening angle, symmetric about the sensor's x axis; 6.28318 is a full turn."""
    number: Annotated[Integer, Field(ge=1, le=1_000_000)] = 100
    """Number of beams. Over a full turn the first and the last point the same way, so 361 beams are 360 directions; for
    exactly 360 beams in 360 directions set `endpoint: false`."""
    endpoint: Bool = True
    """Spread the beams over both ends of `angle_range`. With false the last end has no beam, as in NumPy's `linspace`:
    n beams over a full turn are then n directions."""
    scan_time: Annotated[Seconds, Field(ge=0)] = 0.1
    """Duration of one full turn: it is reported in messages, and counts for `sweep` of `realism`; `rate` says how often
    there is a scan."""
    noise: Bool = False
    """Add Gaussian noise to the ranges of beams that hit something."""
    std: Annotated[Meters, Field(ge=0)] = 0.2
    """Standard deviation of the range noise, with `noise`."""
    angle_std: Annotated[Radians, Field(ge=0)] = 0.0
    """Standard deviation of each beam's direction, with `noise`."""
    offset: Offset = [0.0, 0.0, 0.0]
    """Mounting pose in the body frame: [x, y, theta]."""
    has_velocity: Bool = False
    """Also record the velocity, world frame, of the object that each beam hits."""
    realism: LidarRealism | None = None
    """How ranges err beyond Gaussian noise; null is not at all."""
    plot: BeamPlot = BeamPlot()
    """Drawing options; they take precedence over `alpha` and `color`."""
    alpha: Fraction = 0.3
    """Opacity of the drawn beams."""
    color: Color = "#CC3311"
    """Colour of the drawn beams."""

    @model_validator(mode="before")
    @classmethod
    def _take_device(cls, given: Any) -> Any:
        return with_card(given, DEVICES)

    @property
    def drawn_alpha(self) -> float:
        """Opacity to draw with."""
        return self.alpha if self.plot.alpha is None else self.plot.alpha

    @property
    def drawn_color(self) -> str | tuple[float, ...]:
        """Colour to draw with."""
        color: str | tuple[float, ...] = self.color if self.plot.color is None else self.plot.color
        return color


SENSORS.register(Lidar2d, kernel=core.Lidar2dOptions)
