"""Observation parts of the robot itself and of its goal: ``own``, ``goal``, ``self_state``."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator, Field

import irsim._core as core
from irsim.options.units import Bool, Integer, Meters, MetersPerSecond, Number, Radians, RadiansPerSecond
from irsim.policies.networks.errors import PolicyInputError
from irsim.policies.networks.parts._options import PARTS, PartOptions, unique
from irsim.policies.networks.values import Channel, Frame, Value, turn_back, x_axis
from irsim.policies.observations import Observations

OwnFeature = Literal[
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
    features: Annotated[list[OwnFeature], Field(min_length=1), AfterValidator(unique)] = ["vx", "yaw_rate"]
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
        result: list[Channel] = []
        for name in self.features:
            high = 1.0 if name in ("heading_cos", "heading_sin", "arrived") else most
            low = 0.0 if name in ("speed", "radius", "arrived") else -high
            names = [f"{name}_{i + 1}" for i in range(self.controls)] if name in _PER_CONTROL else [name]
            result += [Channel(each, low, high) for each in names]
        return tuple(result)


PARTS.register(Own, kernel=core.OwnOptions)


GoalFeature = Literal[
    "distance", "nearness", "cos", "sin", "x", "y", "heading_cos", "heading_sin", "threshold", "present"
]


class Goal(PartOptions):
    """Where the goal is, as seen from the robot. Without a goal all numbers are 0.

    - `distance`: distance / `distance_max`
    - `nearness`: exp(-distance / `decay`)
    - `cos`, `sin`: direction of the goal; (1, 0) at the goal itself
    - `x`, `y`: position / `distance_max`
    - `heading_cos`, `heading_sin`: direction of the heading that the goal asks for; 0 if it leaves the heading free
    - `threshold`: distance below which the robot has arrived / `distance_max`
    - `present`: 1 with a goal
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "goal", "features": ["nearness", "cos", "sin"]}]}

    name: Literal["goal"] = "goal"
    features: Annotated[list[GoalFeature], Field(min_length=1), AfterValidator(unique)] = ["distance", "cos", "sin"]
    """The numbers, in this order."""
    frame: Frame = "own"
    """Frame of directions and positions."""
    distance_max: Annotated[Meters, Field(gt=0)] = 4.0
    """Distance that becomes 1."""
    decay: Annotated[Meters, Field(gt=0)] = 1.0
    """Distance at which `nearness` is 1/e."""
    clip: Bool = True
    """Whether distances and positions are clipped to `distance_max`."""

    def channels(self) -> tuple[Channel, ...]:
        """One for each feature."""
        most = 1.0 if self.clip else math.inf
        scaled = {"distance": (0.0, most), "x": (-most, most), "y": (-most, most), "threshold": (0.0, most)}
        shares = {"nearness": (0.0, 1.0), "present": (0.0, 1.0)}
        return tuple(Channel(name, *(scaled | shares).get(name, (-1.0, 1.0))) for name in self.features)


PARTS.register(Goal, kernel=core.GoalOptions)


Heading = Literal["zero", "wrapped", "unwrapped"]


class SelfState(PartOptions):
    """Six numbers in SI units, not clipped; x points to the goal.

    - distance to the goal; 0 without one
    - preferred speed: the upper limit of the first control, which is a speed for every drive
    - heading: 0, or the angle from the direction of the goal to the heading, see `heading`
    - radius of the bounding circle
    - velocity along x and along y

    With a part of neighbors that has `frame: goal`, `distance_max`, `speed_max` and `radius_max` of 1, no clipping and
    the features x, y, vx, vy, radius, distance and radii, these are the joint states of Chen, Liu, Kreiss and Alahi:
    Crowd-Robot Interaction (2019).
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "self_state"}]}

    name: Literal["self_state"] = "self_state"
    heading: Heading = "zero"
    """The third number: 0, as for robots that move in all directions, or the heading minus the direction of the goal
    [rad], `wrapped` into -pi to pi, or `unwrapped` as published."""

    def channels(self) -> tuple[Channel, ...]:
        """The six numbers."""
        most = math.inf
        turned = {"zero": 0.0, "wrapped": math.pi, "unwrapped": most}[self.heading]
        return (
            Channel("goal_distance", 0.0, most),
            Channel("preferred_speed", -most, most),
            Channel("heading", -turned, turned),
            Channel("radius", 0.0, most),
            Channel("vx", -most, most),
            Channel("vy", -most, most),
        )

    def check(self, observations: Observations) -> None:
        """Refuse robots without a limit of their speed."""
        if not np.isfinite(observations.high[:, 0]).all():
            message = "the network observes the largest speed, but a robot's is infinite"
            raise PolicyInputError(message, "give the robot a finite vel_max")


@PARTS.register(SelfState)
def self_state(observations: Observations, options: SelfState) -> Value:
    """(B, 6) numbers."""
    o = observations
    axis = x_axis("goal", o.pose, o.goal)
    there = np.isfinite(o.goal[:, 0]) & np.isfinite(o.goal[:, 1])
    away = np.where(there[:, None], o.goal[:, :2] - o.pose[:, :2], 0.0)
    velocity = turn_back(o.velocity, axis)
    result = np.zeros((len(o), 6))
    result[:, 0] = np.sqrt(away[:, 0] * away[:, 0] + away[:, 1] * away[:, 1])
    result[:, 1] = o.high[:, 0]
    if options.heading == "unwrapped":  # math.atan2, because NumPy's has other last bits on other processors
        result[:, 2] = o.pose[:, 2] - np.array([math.atan2(y, x) for x, y in axis.tolist()])
    elif options.heading == "wrapped":
        ahead = turn_back(x_axis("own", o.pose, o.goal), axis)
        result[:, 2] = [math.atan2(y, x) for x, y in ahead.tolist()]
    result[:, 3] = o.radius
    result[:, 4:] = velocity
    return Value(result)
