"""``own``: the robot itself."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field

import irsim._core as core
from irsim.options.units import Bool, Integer, Meters, MetersPerSecond, Number, Radians, RadiansPerSecond
from irsim.policies.networks.frames import Frame
from irsim.policies.networks.parts._options import PARTS, PartOptions, unique
from irsim.policies.networks.values import Channel

Feature = Literal[
    "vx", "vy", "speed", "yaw_rate", "heading_cos", "heading_sin", "radius", "steering", "arrived",
    "control", "low", "high",
]  # fmt: skip
_PER_CONTROL = ("control", "low", "high")


class Own(PartOptions):
    """The robot's own motion, size and limits.

    - `vx`, `vy`, `speed`: velocity / `speed_max`
    - `yaw_rate`: / `yaw_rate_max`
    - `heading_cos`, `heading_sin`: direction of the heading in `frame`
    - `radius`: radius of the bounding circle / `radius_max`
    - `steering`: steering angle / `steering_max`
    - `arrived`: 1 if the robot has reached its last goal
    - `control`: the control executed last, -1 at the lower limit and 1 at the upper one, 0 without limits
    - `low`, `high`: limits of the controls / `limit_max`
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "own", "features": ["vx", "yaw_rate", "radius"]}]}

    name: Literal["own"] = "own"
    features: Annotated[list[Feature], Field(min_length=1), AfterValidator(unique)] = ["vx", "yaw_rate"]
    """The numbers, in this order; `control`, `low` and `high` are `controls` numbers each."""
    frame: Frame = "own"
    """Frame of velocity and heading."""
    controls: Annotated[Integer, Field(ge=1, le=3)] = 2
    """Number of controls of the drive."""
    speed_max: Annotated[MetersPerSecond, Field(gt=0)] = 1.0
    """Speed that becomes 1."""
    yaw_rate_max: Annotated[RadiansPerSecond, Field(gt=0)] = 3.0
    """Yaw rate that becomes 1."""
    radius_max: Annotated[Meters, Field(gt=0)] = 1.0
    """Radius that becomes 1."""
    steering_max: Annotated[Radians, Field(gt=0)] = 1.0
    """Steering angle that becomes 1."""
    limit_max: Annotated[Number, Field(gt=0)] = 10.0
    """Limit of a control that becomes 1, in its own unit."""
    clip: Bool = True
    """Whether all numbers are clipped to 1."""

    def channels(self) -> tuple[Channel, ...]:
        """One for each feature, or for each feature and control."""
        most = 1.0 if self.clip else math.inf
        found: list[Channel] = []
        for name in self.features:
            high = 1.0 if name in ("heading_cos", "heading_sin", "arrived") else most
            low = 0.0 if name in ("speed", "radius", "arrived") else -high
            names = [f"{name}_{i + 1}" for i in range(self.controls)] if name in _PER_CONTROL else [name]
            found += [Channel(each, low, high) for each in names]
        return tuple(found)


PARTS.register(Own, kernel=core.OwnOptions)
