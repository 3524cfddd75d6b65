"""``arrival``: once for each learner that arrives."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from irsim.common.arrays import Floats
from irsim.learning.features import REWARDS
from irsim.learning.moment import Moment
from irsim.learning.rewards._options import RewardOptions
from irsim.options.units import Bool


class Arrival(RewardOptions):
    """1 in the step in which a learner reaches its last goal for the first time."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "arrival", "weight": 1.0}]}

    name: Literal["arrival"] = "arrival"
    each: Bool = False
    """Whether every goal of several counts, also those of objects that wander."""


@REWARDS.register(Arrival)
def arrival(moment: Moment, options: Arrival) -> Floats:
    """(n, A) 1 for arrivals."""
    return (moment.reached if options.each else moment.arrived).astype(float)
