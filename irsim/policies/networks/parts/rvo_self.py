"""``rvo_self``: the robot itself as RL-RVO observes it."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.options.units import Integer, Meters, MetersPerSecond
from irsim.policies.networks.parts._options import PARTS, PartOptions
from irsim.policies.networks.values import Channel


class RvoSelf(PartOptions):
    """The robot's own motion, the velocity that it desires, and its size, in the world frame and not scaled.

    - `vx`, `vy`: velocity [m/s]
    - `desired_vx`, `desired_vy`: velocity of the desired speed toward the goal [m/s]; 0 at the goal and without one
    - `heading`: from -pi to pi [rad]
    - `radius`: radius of the bounding circle plus `margin` [m]

    Source: Han et al.: Reinforcement Learned Distributed Multi-Robot Navigation With Reciprocal Velocity Obstacle
    Shaped Rewards (2022).
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "rvo_self", "margin": 0.1}]}

    name: Literal["rvo_self"] = "rvo_self"
    speed: Annotated[MetersPerSecond, Field(gt=0)] | None = None
    """Desired speed; null is the upper limit of the first control of each robot, or 1 m/s without a limit."""
    margin: Annotated[Meters, Field(ge=0)] = 0.1
    """Added to the robot's own radius."""
    decimals: Annotated[Integer, Field(ge=0, le=9)] | None = 2
    """Numbers are rounded to so many decimals; null keeps them."""

    def channels(self) -> tuple[Channel, ...]:
        """One for each number."""
        names = ("vx", "vy", "desired_vx", "desired_vy")
        free = [Channel(name, -math.inf, math.inf) for name in names]
        turn = math.ceil(math.pi * 10**9) / 10**9 if self.decimals is None else math.pi + 10.0**-self.decimals
        return (*free, Channel("heading", -turn, turn), Channel("radius", 0.0, math.inf))


PARTS.register(RvoSelf, kernel=core.RvoSelfOptions)
