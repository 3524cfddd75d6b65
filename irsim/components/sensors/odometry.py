"""``odometry``: the pose that the turns of two wheels add up to."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.sensors._gauges import DriftOptions
from irsim.options.registry import SENSORS
from irsim.options.units import Integer, Meters, Number

Share = Annotated[Number, Field(gt=-0.5, lt=0.5)]
Spread = Annotated[Number, Field(ge=0, le=0.2)]


class Odometry(DriftOptions):
    """Wheel odometry: the pose that encoders of two wheels add up to, from the true start on; it drifts.

    It follows the turns of the wheels, not the body: on `world.zones` with `slip` it reports the full way, of
    `skid_steer` what its controller believes, and of `single_track` no slide sideways. Systematic errors are as in
    UMBmark (Borenstein and Feng 1996): unequal diameters and a wrong track. The sideways part of omnidirectional drives
    has the error of scale.
    """

    locates: ClassVar[bool] = True
    reports: ClassVar[tuple[str, ...]] = ("x", "y", "theta", "vx", "vy", "yaw_rate", "left", "right")
    report_units: ClassVar[tuple[str, ...]] = ("m", "m", "rad", "m/s", "m/s", "rad/s", "ticks", "ticks")
    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "odometry", "track": 0.16, "track_std": 0.01, "heading_noise": 0.02}]
    }

    name: Literal["odometry"] = "odometry"
    track: Annotated[Meters, Field(gt=0)] = 0.3
    """Distance of the wheels, as the robot believes."""
    wheel_radius: Annotated[Meters, Field(gt=0)] = 0.05
    """Radius of the wheels, as the robot believes."""
    ticks_per_turn: Annotated[Integer, Field(ge=0, le=10_000_000)] = 0
    """Ticks of an encoder per turn of its wheel; 0 measures turns exactly, and reports turns instead of ticks."""
    diameter_error: Share = 0.0
    """True diameter of the right wheel over the left one, minus 1."""
    track_error: Share = 0.0
    """True track over `track`, minus 1."""
    scale_error: Share = 0.0
    """True mean radius over `wheel_radius`, minus 1."""
    diameter_std: Spread = 0.0
    """Standard deviation of what each episode adds to `diameter_error`."""
    track_std: Spread = 0.0
    """Standard deviation of what each episode adds to `track_error`."""
    scale_std: Spread = 0.0
    """Standard deviation of what each episode adds to `scale_error`."""


SENSORS.register(Odometry, kernel=core.OdometryOptions)
