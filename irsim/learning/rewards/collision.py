"""``collision``: once for each learner that begins to collide."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from irsim.common.arrays import Floats
from irsim.learning.features import REWARDS
from irsim.learning.moment import Moment
from irsim.learning.rewards._options import RewardOptions
from irsim.options.units import Number


class Collision(RewardOptions):
    """1 in the step in which a learner begins to touch something."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "collision", "weight": -3.0}]}

    name: Literal["collision"] = "collision"
    weight: Number = -1.0
    """Factor of the term; negative for a cost."""


@REWARDS.register(Collision)
def collision(moment: Moment, options: Collision) -> Floats:
    """(n, A) 1 for collisions that begin."""
    return moment.collided.astype(float)
