"""``arrival``: once for each learner that arrives."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import irsim._core as core
from irsim.learning.features import REWARDS
from irsim.learning.rewards._options import RewardOptions
from irsim.options.units import Bool


class Arrival(RewardOptions):
    """1 in the step in which a learner reaches its last goal for the first time."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "arrival", "weight": 1.0}]}

    name: Literal["arrival"] = "arrival"
    each: Bool = False
    """Whether every goal of several counts, also for objects that wander."""


REWARDS.register(Arrival, kernel=core.ArrivalOptions)
