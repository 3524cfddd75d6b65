"""``collision``: once for each learner that begins to collide."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import irsim._core as core
from irsim.learning.features import REWARDS
from irsim.learning.rewards._options import RewardOptions
from irsim.options.units import Number


class Collision(RewardOptions):
    """1 in the step in which a learner begins to touch something."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "collision", "weight": -3.0}]}

    name: Literal["collision"] = "collision"
    weight: Number = -1.0
    """Factor of the term; negative for a cost."""


REWARDS.register(Collision, kernel=core.CollisionOptions)
