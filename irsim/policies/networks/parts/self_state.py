"""``self_state``: the robot itself in the frame of its goal, as value networks of crowd navigation observe it."""

from __future__ import annotations

import math
from typing import Any, ClassVar, Literal

import numpy as np

from irsim.policies.networks.errors import PolicyInputError
from irsim.policies.networks.frames import turn_back, x_axis
from irsim.policies.networks.parts._options import PARTS, PartOptions
from irsim.policies.networks.values import Channel, Value
from irsim.policies.observations import Observations

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
            message = "the network observes the largest speed, and a robot has none"
            raise PolicyInputError(message, "give the robot a finite vel_max")


@PARTS.register(SelfState)
def self_state(observations: Observations, options: SelfState) -> Value:
    """(B, 6) numbers."""
    o = observations
    axis = x_axis("goal", o.pose, o.goal)
    there = np.isfinite(o.goal[:, 0]) & np.isfinite(o.goal[:, 1])
    away = np.where(there[:, None], o.goal[:, :2] - o.pose[:, :2], 0.0)
    velocity = turn_back(o.velocity, axis)
    found = np.zeros((len(o), 6))
    found[:, 0] = np.sqrt(away[:, 0] * away[:, 0] + away[:, 1] * away[:, 1])
    found[:, 1] = o.high[:, 0]
    if options.heading == "unwrapped":  # math.atan2, because that of NumPy has other last bits on other processors
        found[:, 2] = o.pose[:, 2] - np.array([math.atan2(y, x) for x, y in axis.tolist()])
    elif options.heading == "wrapped":
        ahead = turn_back(x_axis("own", o.pose, o.goal), axis)
        found[:, 2] = [math.atan2(y, x) for x, y in ahead.tolist()]
    found[:, 3] = o.radius
    found[:, 4:] = velocity
    return Value(found)
