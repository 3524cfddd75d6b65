"""``time``: seconds that pass."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import numpy as np

from irsim.common.arrays import Floats
from irsim.learning.features import REWARDS
from irsim.learning.moment import Moment
from irsim.learning.rewards._options import RewardOptions
from irsim.options.units import Number


class Time(RewardOptions):
    """Seconds that have passed, so that a way that takes less time is worth more."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "time", "weight": -0.1}]}

    name: Literal["time"] = "time"
    weight: Number = -0.1
    """Factor of the term; negative for a cost."""


@REWARDS.register(Time)
def time(moment: Moment, options: Time) -> Floats:
    """(n, A) duration of the step [s]."""
    return np.full(moment.arrived.shape, moment.step_time)
