"""``social``: how far a learner comes into the personal space of people."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.learning.features import REWARDS
from irsim.learning.rewards._options import RewardOptions
from irsim.options.units import Meters, Number


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
