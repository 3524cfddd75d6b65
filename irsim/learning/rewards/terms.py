"""Reward terms: about a learner's own motion, about what surrounds it, and a function of the user."""

from __future__ import annotations

import importlib
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.diagnostics.errors import ArgumentError
from irsim.learning.rewards._options import REWARDS, RewardOptions
from irsim.learning.step import Moment
from irsim.options.units import Bool, Meters, MetersPerSecond, Number


class Arrival(RewardOptions):
    """1 in the step in which a learner reaches its last goal for the first time."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "arrival", "weight": 1.0}]}

    name: Literal["arrival"] = "arrival"
    each: Bool = False
    """Whether every goal of several counts, also for objects that wander."""


REWARDS.register(Arrival, kernel=core.ArrivalOptions)


class Collision(RewardOptions):
    """1 in the step in which a learner begins to touch something."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "collision", "weight": -3.0}]}

    name: Literal["collision"] = "collision"
    weight: Number = -1.0
    """Factor of the term; negative for a cost."""


REWARDS.register(Collision, kernel=core.CollisionOptions)


class Progress(RewardOptions):
    """Metres by which the straight distance to the goal has shrunk; negative when it has grown.

    The sum over an episode does not depend on the way that is taken (potential-based shaping, Ng, Harada and Russell
    1999), so that this term alone changes no optimal policy.
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "progress", "weight": 1.0}]}

    name: Literal["progress"] = "progress"


REWARDS.register(Progress, kernel=core.ProgressOptions)


class Smoothness(RewardOptions):
    """The square of a change or of a turn, as a share of what the limits allow, per second.

    - `change`: of the controls since the step before, as a share of the interval between their limits, the mean over
      the controls
    - `turning`: of the yaw rate, as a share of 1 rad/s
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "smoothness", "weight": -0.1, "of": "turning"}]}

    name: Literal["smoothness"] = "smoothness"
    weight: Number = -0.1
    """Factor of the term; negative for a cost."""
    of: Literal["change", "turning"] = "change"
    """The quantity that should be small."""


REWARDS.register(Smoothness, kernel=core.SmoothnessOptions)


class Time(RewardOptions):
    """Seconds that have passed, so that a way that takes less time is worth more."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "time", "weight": -0.1}]}

    name: Literal["time"] = "time"
    weight: Number = -0.1
    """Factor of the term; negative for a cost."""


REWARDS.register(Time, kernel=core.TimeOptions)


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


class Python(RewardOptions):
    """The value that your function returns for all learners of all worlds at once.

    It gets an `irsim.learning.Moment` and returns an (n, A) array.
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "python", "function": "my_rewards:speed"}]}

    name: Literal["python"] = "python"
    function: Annotated[str, Field(pattern=r"^[A-Za-z_][\w.]*:[A-Za-z_]\w*$")]
    """Module and name of the function: `my_rewards:speed`. The module must be one that Python can import."""


@REWARDS.register(Python)
def python(moment: Moment, options: Python) -> Floats:
    """(n, A) what the function returns.

    Raises:
        ArgumentError: There is no such function, or it returns something else.
    """
    module, name = options.function.split(":")
    try:
        function = getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError) as error:
        what = f"the reward function {options.function!r} cannot be imported: {error}"
        raise ArgumentError(what, "give MODULE:FUNCTION of a module that Python finds") from error
    rewards = np.asarray(function(moment), dtype=np.float64)
    if rewards.shape != moment.arrived.shape or not np.isfinite(rewards).all():
        given = f"shape {rewards.shape}" if rewards.shape != moment.arrived.shape else "numbers that are not finite"
        what = f"the reward function {options.function!r} returned {given}"
        raise ArgumentError(what, f"return finite numbers of shape {moment.arrived.shape}: worlds x learners")
    return rewards
