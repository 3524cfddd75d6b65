"""Reward terms about a learner's own motion: arrivals, collisions, progress, smoothness and time."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import irsim._core as core
from irsim.learning.rewards._options import REWARDS, RewardOptions
from irsim.options.units import Bool, Number


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
