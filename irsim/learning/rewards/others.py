"""Reward terms about what surrounds a learner: clearance, personal space, velocity obstacles."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.learning.rewards._options import REWARDS, RewardOptions
from irsim.learning.step import Moment
from irsim.options.units import Meters, MetersPerSecond, Number


class Clearance(RewardOptions):
    """The share of `margin` that is missing between the footprints of a learner and of what is nearest, per second.

    0 from a gap of `margin` on, 1 for a touch.
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "clearance", "weight": -1.5, "margin": 0.15}]}

    name: Literal["clearance"] = "clearance"
    weight: Number = -1.0
    """Factor of the term; negative for a cost."""
    margin: Annotated[Meters, Field(gt=0)] = 0.2
    """Gap from which on nothing is missing."""
    to: Literal["all", "robots", "obstacles"] = "all"
    """Objects to keep away from: other robots, obstacles (static and moving ones), or all of them."""


REWARDS.register(Clearance, kernel=core.ClearanceOptions)


class Social(RewardOptions):
    """The share of `distance` that is missing to the nearest person, per second; people are obstacles that move.

    0 from a gap of `distance` on, 1 for a touch (the discomfort of Chen, Liu, Kreiss and Alahi 2019, per second).
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "social", "weight": -1.0, "distance": 0.2}]}

    name: Literal["social"] = "social"
    weight: Number = -1.0
    """Factor of the term; negative for a cost."""
    distance: Annotated[Meters, Field(gt=0)] = 0.2
    """Smallest gap that disturbs no person."""


REWARDS.register(Social, kernel=core.SocialOptions)

_OFFSET_S = 0.2
"""Added to times before their inverse is taken [s]."""
_SUDDEN_S = 0.1
"""Times to a touch below this one count `sudden` times [s]."""
_SPEED_RANGE = 3.0
"""Difference of velocities that becomes 1 [m/s]."""


class Rvo(RewardOptions):
    """The reward of RL-RVO for the velocity that a learner commands, which must be one of velocities.

    With the time t until it would touch another one (see the observation part `rvo_cones`) and the difference d between
    this velocity and the one of full speed toward the goal: `base` - `deviation` d / (3 m/s) if there is no such time
    within 5 s, else `base` - `threat` 0.2 s / (t + 0.2 s), `sudden` times that much below 0.1 s.

    Source: Han et al.: Reinforcement Learned Distributed Multi-Robot Navigation With Reciprocal Velocity Obstacle
    Shaped Rewards (2022).
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "rvo", "weight": 0.1}]}

    name: Literal["rvo"] = "rvo"
    base: Number = 0.3
    """Reward of every step."""
    deviation: Annotated[Number, Field(ge=0)] = 3.0
    """Cost of a velocity away from the goal."""
    threat: Annotated[Number, Field(ge=0)] = 6.0
    """Cost of a touch that is near."""
    sudden: Annotated[Number, Field(ge=0)] = 3.0
    """Factor of this cost for a touch within 0.1 s."""
    speed: Annotated[MetersPerSecond, Field(gt=0)] | None = None
    """Full speed; null is the upper limit of the first control of each learner, or 1 m/s without a limit."""


@REWARDS.register(Rvo)
def rvo(moment: Moment, options: Rvo) -> Floats:
    """(n, A) reward of the commanded velocities, 0 without a goal."""
    limit = moment.high[:, :, 0] if options.speed is None else np.full(moment.arrived.shape, options.speed)
    speed = np.where(np.isfinite(limit), limit, 1.0)
    away = moment.commanded - speed[:, :, None] * moment.direction_before
    difference = np.sqrt(away[:, :, 0] * away[:, :, 0] + away[:, :, 1] * away[:, :, 1])
    urgency = moment.urgency()
    factor = np.where(urgency > 1.0 / (_SUDDEN_S + _OFFSET_S), options.sudden, 1.0)
    threatened = options.base - factor * options.threat * _OFFSET_S * urgency
    free = options.base - options.deviation * difference / _SPEED_RANGE
    there = np.isfinite(moment.distance_before)
    value: Floats = np.where(there, np.where(urgency > 0, threatened, free), 0.0)
    return value
