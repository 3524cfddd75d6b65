"""``smoothness``: how hard controls change."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import irsim._core as core
from irsim.learning.features import REWARDS
from irsim.learning.rewards._options import RewardOptions
from irsim.options.units import Number


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
