"""``clearance``: how far a learner is inside a margin around others."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.learning.features import REWARDS
from irsim.learning.rewards._options import RewardOptions
from irsim.options.units import Meters, Number


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
    """What keeps the learner at a distance: other robots, obstacles (static and moving ones), or all of them."""


REWARDS.register(Clearance, kernel=core.ClearanceOptions)
