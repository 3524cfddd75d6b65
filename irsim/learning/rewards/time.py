"""``time``: seconds that pass."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import irsim._core as core
from irsim.learning.features import REWARDS
from irsim.learning.rewards._options import RewardOptions
from irsim.options.units import Number


class Time(RewardOptions):
    """Seconds that have passed, so that a way that takes less time is worth more."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "time", "weight": -0.1}]}

    name: Literal["time"] = "time"
    weight: Number = -0.1
    """Factor of the term; negative for a cost."""


REWARDS.register(Time, kernel=core.TimeOptions)
